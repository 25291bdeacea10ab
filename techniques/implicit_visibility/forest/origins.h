// The origin of surface elements: leaves on the scene at rest, in segments (Dong et al. 2007, Sec. 4.1).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "../elements/element_tree.h"
#include "lumivox/scene/atlas.h"
#include "lumivox/scene/scene.h"

namespace lumivox::implicit_visibility {

/// What leaves stand for. atlas: texels of makeSurfaceAtlas, independent of the tessellation. vertices: the
/// loaded vertices, as published, each with a third of the area of its triangles.
enum class Source { atlas, vertices };
/// What segments are. charts: connected pieces within 45 degrees. uv: islands of the texture coordinates, as
/// published.
enum class Segments { charts, uv };

struct OriginSettings {
  Source source = Source::atlas;
  Segments segments = Segments::charts;
  double elements = 4096;  ///< approximate number of leaves with Source::atlas
  double share = 0.5;      ///< an object's share of them is proportional to this power of its area
};

/// A leaf on the scene at rest. With Source::vertices `triangle` is the first triangle of the vertex.
struct Leaf {
  std::uint32_t object = 0;           ///< index into Scene::objects
  std::uint32_t triangle = 0;         ///< its first index in Scene::indices divided by three
  float second = 0.0f, third = 0.0f;  ///< barycentric coordinates of its second and third corner
  std::uint32_t vertex = kNoElement;  ///< of Source::vertices: index into Scene::positions
  float area = 0.0f;                  ///< m^2, less holes of masks
  AtlasOutline outline{};     ///< of Source::atlas; holes of masks make it smaller about the leaf's place
  std::uint32_t segment = 0;  ///< numbers in no order; leaves of different objects share none
  glm::dvec2 place{0.0};      ///< in the plane of its segment, in a unit that its neighbours share
  glm::vec3 albedo{0.0f};
  glm::vec4 specular{0.0f};  ///< Phong albedo; w exponent
  glm::vec3 emission{0.0f};  ///< W/(sr m^2), from the front
};

struct Origins {
  std::vector<Leaf> leaves;
  /// With Source::vertices: the triangles of each leaf, leaf after leaf.
  std::vector<std::uint32_t> firstTriangle, triangles;
  /// Names of objects without texture coordinates, whose charts stand in for islands.
  std::string withoutTexcoords;
};

/// Error with the bytes where there is no room for so many elements (OriginSettings::elements).
Origins findOrigins(const Scene& scene, const OriginSettings& settings);

}  // namespace lumivox::implicit_visibility
