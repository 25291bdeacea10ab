// A texture atlas of a whole scene: every piece of surface has texels of its own in one square.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "lumivox/scene/scene.h"

namespace lumivox {

/// A texel on the surface, with its position on a triangle, so that it moves and deforms with the triangle.
struct AtlasTexel {
  std::uint16_t x = 0, y = 0;         ///< in the square
  std::uint32_t triangle = 0;         ///< of Scene::indices: its first index divided by three
  float second = 0.0f, third = 0.0f;  ///< barycentric coordinates of its second and third corner
  float area = 0.0f;  ///< of the surface within the texel, m^2 at rest; those of all sum to the surface's
  std::uint32_t chart = 0;  ///< 0 .. SurfaceAtlas::chartCount - 1
  bool operator==(const AtlasTexel&) const = default;
};

/// The surface within a texel as a convex polygon in the plane of the texel's triangle: the hull of that
/// surface, projected along the chart's axis onto that plane. Where the surface does not fill its hull, or
/// the hull has more corners than are kept, the polygon is scaled about the texel's place to the surface's
/// area. So whole texels and straight cuts of a flat chart tile it. Where the surface's normals within the
/// texel turn away from their mean by an angle, its edges lie up to sin(angle) / 4 of a side off the
/// polygon's plane, and neighbours in planes of their own would leave gaps. So that polygon is larger by
/// kOverlap sin(angle), which closes them as seen at slants of up to 63 degrees. There is none beyond
/// kMostBend, where it would count as much as a disc of radius sqrt(A/2): (1 + kOverlap kMostBend)^2 is pi/2.
struct AtlasOutline {
  static constexpr std::size_t kMostCorners = 8;
  static constexpr double kOverlap = 1.0, kMostBend = 0.253;  ///< the latter a sine, of some 15 degrees
  /// From the texel's place, as steps of AtlasTexel::second and third, counter-clockwise along the chart's
  /// axis. A corner may lie outside of the triangle.
  std::array<glm::vec2, kMostCorners> corners{};
  std::uint32_t count = 0;  ///< 3 to kMostCorners; 0: the surface bends too much or has no extent
  bool operator==(const AtlasOutline&) const = default;
};

/// The texels of one part of one object.
struct AtlasPart {
  std::uint32_t firstTexel = 0, texelCount = 0;
};

struct SurfaceAtlas {
  int side = 0;  ///< texels along a side of the square
  std::size_t chartCount = 0;
  std::vector<AtlasTexel> texels;  ///< those that lie on the surface, by parts; at most one for each place
  std::vector<AtlasOutline> outlines;  ///< of `texels`, with AtlasPlaces::middles; else empty
  std::vector<AtlasPart> parts;        ///< of all objects, in their order
  /// The chart of each triangle of Scene::indices; kNoChart for one that no object has.
  std::vector<std::uint32_t> chartOfTriangle;
  static constexpr std::uint32_t kNoChart = 0xffffffffu;
};

/// Where the place of a texel is. centres: at the texel's centre, as makeSurfaceAtlas says. middles: at the
/// middle of the surface within the texel; the texels of a chart are then changed so that they divide its
/// rectangle evenly, by 2 or 4 where there are several, and texels that the surface hardly enters (10^-6 of
/// their area) are left out.
enum class AtlasPlaces { centres, middles };

/// Charts are clusters of triangles that share edges and lie within kLargestChartTilt of their first one;
/// each is projected along that one's normal onto square texels of `texelSize` metres at rest, so that
/// centres of neighbouring texels are at most texelSize / cos(kLargestChartTilt) apart on the surface. A
/// texel belongs to the triangle that its centre lies in; at a chart's border, where it lies in none, to the
/// nearest one that it touches, at the nearest point. A chart that would cover itself is cut. No point of the
/// surface is farther than 3.5 texels from the place of one. The same scene always gives the same atlas.
/// Error when the texels would be more than kMostAtlasTexels.
SurfaceAtlas makeSurfaceAtlas(const Scene& scene, double texelSize);
/// The same with a texel size of its own for each of Scene::objects.
SurfaceAtlas makeSurfaceAtlas(const Scene& scene, const std::vector<double>& texelSizes,
                              AtlasPlaces places = AtlasPlaces::centres);

inline constexpr double kLargestChartTilt = 0.7853981633974483;  ///< 45 degrees, rad
inline constexpr std::uint64_t kMostAtlasTexels = std::uint64_t{1} << 25;

}  // namespace lumivox
