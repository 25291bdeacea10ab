// Reference for voxels: light transport over the boxes of set voxels, by plain Monte Carlo on Embree. A
// technique that sends rays through voxels differs from it only by noise, and it differs from the triangles
// only by the voxelization. The caller gives the reflectance and radiance of a box.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "lumivox/scene/grid.h"

namespace lumivox {

/// Where a ray meets a box; lengths along the ray in units of its direction's length.
struct BoxHit {
  glm::ivec3 voxel;
  double enter = 0.0;  ///< 0 where the ray begins in the box
  double leave = 0.0;
  glm::dvec3 origin, direction;  ///< of the ray, m
  double end = 0.0;              ///< where the ray ends: `enter`, or at the surface within the box
  glm::dvec3 normal{0.0};        ///< of that surface; zero: the ray ends at the box
  glm::dvec3 middle() const { return origin + 0.5 * (enter + leave) * direction; }
  glm::dvec3 place() const { return origin + end * direction; }
};

/// The surface within a box at which a ray ends, as in BoxHit.
struct BoxStop {
  double end = 0.0;
  glm::dvec3 normal{0.0};
};
/// Tells where a ray ends within a box that it enters; nothing: it passes. Called by several threads at once.
using StopWithin = std::function<std::optional<BoxStop>(const BoxHit&)>;

/// The set voxels of a grid as boxes. The slabs of a box are tested in double precision. Rays end where they
/// enter a box, or where `stop` says.
class VoxelBoxes {
 public:
  VoxelBoxes(std::span<const glm::ivec3> voxels, const GridPlacement& grid, StopWithin stop = {});
  ~VoxelBoxes();
  VoxelBoxes(VoxelBoxes&&) noexcept;
  VoxelBoxes& operator=(VoxelBoxes&&) noexcept;

  /// The first box of a ray in which it ends, at `reach` at most.
  std::optional<BoxHit> first(const glm::dvec3& origin, const glm::dvec3& direction, double reach) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

/// Where the rays of a pixel begin.
struct BoxStart {
  glm::dvec3 place{0.0};   ///< m, relative to the snapshot's origin as the grid is
  glm::dvec3 normal{0.0};  ///< unit length; rays are distributed as the cosine to it. Zero: none begin here
};

/// How a box reflects, where paths go on from it.
struct BoxSurface {
  BoxStart start;  ///< of the rays that go on
  glm::dvec3 albedo{0.0};
};

struct BoxTransport {
  /// Radiance that a box sends back along the ray, W/(sr m^2).
  std::function<glm::dvec3(const BoxHit&)> radiance;
  /// Needed for more than one bounce.
  std::function<BoxSurface(const BoxHit&)> surface;
  glm::dvec3 environment{0.0};     ///< radiance seen by rays that meet nothing, W/(sr m^2)
  double reach = 0.0;              ///< of light, m; 0: without end
  double occlusionDistance = 0.0;  ///< m
  int bounces = 1;
  int samples = 256;  ///< a pixel; at least 2
  std::uint64_t seed = 1;
};

/// Of one pixel.
struct BoxLight {
  glm::dvec3 arriving{0.0};  ///< mean radiance, W/(sr m^2): E / pi
  glm::dvec3 variance{0.0};  ///< of that mean
  double open = 1.0;         ///< share of directions without a box within the occlusion distance
  double openVariance = 0.0;
};

/// Numbers do not depend on the threads. Error with fewer than two samples, without `radiance`, or without
/// `surface` where there are several bounces.
std::vector<BoxLight> transportThroughBoxes(const VoxelBoxes& boxes, std::span<const BoxStart> starts,
                                            const BoxTransport& transport);

}  // namespace lumivox
