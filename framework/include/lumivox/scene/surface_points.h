// Points spread evenly over the surfaces of a scene, which move and deform with them.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "lumivox/scene/grid.h"
#include "lumivox/scene/scene.h"

namespace lumivox {

/// A place on a triangle, which follows whatever the triangle does.
struct SurfacePlace {
  std::uint32_t triangle = 0;         ///< of Scene::indices: its first index divided by three
  float second = 0.0f, third = 0.0f;  ///< barycentric coordinates of its second and third corner
  bool operator==(const SurfacePlace&) const = default;
};

/// One side of the surface around a place.
struct SurfacePoint {
  SurfacePlace place;
  SurfacePlace farthest;     ///< of the places on this side to which this is the nearest point of its model
  std::uint32_t object = 0;  ///< index into Scene::objects
  std::uint32_t model = 0;   ///< modelsOf()
  int material = 0;          ///< index into Scene::materials
  bool back = false;         ///< the side that triangles turn their backs to; the front is then a point too
  float area = 0.0f;         ///< of this side of the surface that it stands for, m^2 at rest
  float reach = 0.0f;  ///< m at rest: no place on this side that is farther has it among its nearest points
  bool operator==(const SurfacePoint&) const = default;
};

struct SurfacePointSet {
  std::vector<SurfacePoint> points;  ///< by models
  int neighbours = 0;                ///< nearest points that `reach` is for
  double area = 0.0;                 ///< of all sides that have points, m^2 at rest
  /// m: side of the square that a point stands for, in the mean.
  double spacing() const;
};

struct SurfacePointSettings {
  int points = 2048;
  int neighbours = 8;
};

/// Spreads points over all objects at rest: on both sides of open surfaces, on the front of closed ones, none
/// in the holes of masks. Of each model so many that points are as dense everywhere, one at least; together
/// at most `points`, or one for each side of each model where that is more. The same scene always gives the
/// same points, whatever the number of threads.
SurfacePointSet spreadSurfacePoints(const Scene& scene, const SurfacePointSettings& settings);

/// Where the points are at one moment. Positions are relative to SceneSnapshot::origin. A point whose
/// triangle has become a line or a point has no normal (0), no area and no radius.
struct SurfacePointState {
  std::vector<glm::vec3> position, normal;  ///< m; unit, to the point's side
  std::vector<float> area, radius, reach;   ///< m^2; m: to SurfacePoint::farthest; m
};
SurfacePointState stateOf(const SurfacePointSet& set, const Scene& scene, const SceneSnapshot& snapshot);

/// Points by cells, so that the nearest ones are found from any place of the surface: a cell lists all points
/// within whose reach some of it is, of all models and both sides, by growing numbers.
struct SurfacePointGrid {
  GridPlacement placement;
  std::vector<std::uint32_t> first;   ///< of each cell, x fastest, and one more
  std::vector<std::uint32_t> points;  ///< numbers
};
SurfacePointGrid gridOf(const SurfacePointSet& set, const SurfacePointState& state);

}  // namespace lumivox
