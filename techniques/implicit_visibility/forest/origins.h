// Where surface elements come from: leaves on the scene at rest, in segments (Dong et al. 2007, Sec. 4.1).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "../elements/element_tree.h"
#include "lumivox/scene/atlas.h"
#include "lumivox/scene/scene.h"

namespace lumivox::implicit_visibility {

/// What leaves stand for. atlas: texels of makeSurfaceAtlas, whatever the tessellation. vertices: the loaded
/// vertices, as published, each with a third of the area of its triangles.
enum class Source { atlas, vertices };
/// What segments are. charts: pieces that hang together within 45 degrees. uv: islands of the texture
/// coordinates, as published.
enum class Segments { charts, uv };

struct OriginSettings {
  Source source = Source::atlas;
  Segments segments = Segments::charts;
  double elements = 4096;  ///< about how many leaves, with Source::atlas
  double share = 0.5;      ///< an object's part of them goes by this power of its area
};

/// A leaf on the scene at rest. Of Source::vertices `triangle` is the first that the vertex belongs to.
struct Leaf {
  std::uint32_t object = 0;           ///< index into Scene::objects
  std::uint32_t triangle = 0;         ///< its first index in Scene::indices divided by three
  float second = 0.0f, third = 0.0f;  ///< barycentric coordinates of its second and third corner
  std::uint32_t vertex = kNoElement;  ///< of Source::vertices: index into Scene::positions
  float area = 0.0f;                  ///< m^2, less holes of masks
  AtlasOutline outline{};     ///< of Source::atlas; holes of masks make it smaller about the leaf's place
  std::uint32_t segment = 0;  ///< numbers in no order; only leaves of one object share one
  glm::dvec2 place{0.0};      ///< in the plane of its segment, in a unit that its neighbours share
  glm::vec3 albedo{0.0f};
  glm::vec4 specular{0.0f};  ///< Phong albedo; w exponent
  glm::vec3 emission{0.0f};  ///< W/(sr m^2), from the front
};

struct Origins {
  std::vector<Leaf> leaves;
  /// Of Source::vertices: the triangles of each leaf, one leaf behind the other.
  std::vector<std::uint32_t> firstTriangle, triangles;
  /// Names of the objects whose charts stand in for islands, since they have no texture coordinates.
  std::string withoutTexcoords;
};

/// Error when the scene has no room for so many (Settings::elements), naming the bytes.
Origins findOrigins(const Scene& scene, const OriginSettings& settings);

}  // namespace lumivox::implicit_visibility
