// Points spread evenly over the surfaces of a scene, which move and deform with them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "lumivox/scene/grid.h"
#include "lumivox/scene/scene.h"

namespace lumivox::virtual_area_lights {

/// A place on a triangle that moves with it.
struct SurfacePlace {
  std::uint32_t triangle = 0;         ///< of Scene::indices: its first index divided by three
  float second = 0.0f, third = 0.0f;  ///< barycentric coordinates of its second and third corner
  bool operator==(const SurfacePlace&) const = default;
};

/// One side of the surface around a place: the part nearer to it than to any other point of its model.
/// Measures are those at rest.
struct SurfacePoint {
  SurfacePlace place;
  std::uint32_t object = 0;  ///< index into Scene::objects
  std::uint32_t model = 0;   ///< modelsOf()
  int material = 0;          ///< index into Scene::materials
  bool back = false;         ///< the back of the surface; the point before this one is then its front
  float area = 0.0f;         ///< m^2
  float radius = 0.0f;       ///< m: the farthest place that it stands for
  float reach = 0.0f;        ///< m: the farthest place for which it is among the nearest points
  bool operator==(const SurfacePoint&) const = default;
};

struct SurfacePointSet {
  std::vector<SurfacePoint> points;  ///< by models
  double area = 0.0;                 ///< area of all sides with points, m^2 at rest
  /// m: side of the square that a point stands for, in the mean; 0 without points.
  double spacing() const;
  /// m: how far away neighbours are sought; the nearest one may be farther.
  double farthest = 0.0;
};

struct SurfacePointSettings {
  int points = 2048;
  int neighbours = 8;  ///< number of nearest points that SurfacePoint::reach serves
};

/// A surface's neighbours lie on its own side: normals at a larger angle are of the other one, 2/3 pi.
/// kOtherSideCosine of shaders/virtual_area_lights/surface_points.glsl.
inline constexpr float kOtherSideCosine = -0.5f;

/// Candidates from which each point is chosen, in the mean.
inline constexpr int kCandidatesPerPoint = 10;

/// Spreads points over all objects at rest as blue noise: on both sides of open surfaces, on the front of
/// closed ones (scene/topology.h), none in holes of masks. Their density is the same on all models; each
/// model has at least one. Together they are at most `points`, or one place per model if that is more. The
/// same scene always gives the same points.
SurfacePointSet spreadSurfacePoints(const Scene& scene, const SurfacePointSettings& settings);

/// The points at one time. Positions are relative to SceneSnapshot::origin. A point whose triangle has become
/// a line or a point has zero normal, area, radius and reach.
struct SurfacePointState {
  std::vector<glm::vec3> position, normal;  ///< m; shading normal of unit length, to the point's side
  std::vector<float> area, radius,
      reach;  ///< m^2, m, m: they stretch with the triangles of deforming objects
};
SurfacePointState stateOf(const SurfacePointSet& set, const Scene& scene, const SceneSnapshot& snapshot);

/// Points by cells, to find the nearest ones from any place of the surface. A cell lists, by increasing
/// numbers, all points whose reach touches it, of all models and both sides.
struct SurfacePointGrid {
  GridPlacement placement;
  std::vector<std::uint32_t> first;   ///< of each cell, x fastest, and one more
  std::vector<std::uint32_t> points;  ///< numbers

  /// Bounds the number of cells and the total length of their lists; cells become wider to stay within it.
  static constexpr std::uint64_t mostCells(std::uint64_t points) {
    return std::max<std::uint64_t>(8 * points, 32768);
  }
  static constexpr std::uint64_t mostEntries(std::uint64_t points) { return 120 * points; }
};
SurfacePointGrid gridOf(const SurfacePointSet& set, const SurfacePointState& state);

}  // namespace lumivox::virtual_area_lights
