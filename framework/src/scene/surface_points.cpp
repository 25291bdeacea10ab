#include "lumivox/scene/surface_points.h"

#include <cmath>

namespace lumivox {

double SurfacePointSet::spacing() const {
  return points.empty() ? 0.0 : std::sqrt(area / static_cast<double>(points.size()));
}

SurfacePointSet spreadSurfacePoints(const Scene&, const SurfacePointSettings& settings) {
  SurfacePointSet set;
  set.neighbours = settings.neighbours;
  return set;
}

SurfacePointState stateOf(const SurfacePointSet&, const Scene&, const SceneSnapshot&) {
  return {};
}

SurfacePointGrid gridOf(const SurfacePointSet&, const SurfacePointState&) {
  return {.placement = {.resolution = glm::ivec3(1)}, .first = {0, 0}, .points = {}};
}

}  // namespace lumivox
