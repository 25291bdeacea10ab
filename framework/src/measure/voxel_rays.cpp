// Straight rays through two sets of voxels at once.
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "lumivox/base/low_discrepancy.h"
#include "lumivox/measure/voxels.h"
#include "measure/voxel_resolution.h"

namespace lumivox {
namespace {

struct Ray {
  glm::dvec3 origin, direction;  ///< in voxels; the direction has unit length
};

struct Crossings {
  std::uint64_t all = 0, holes = 0;
};

/// The part of a ray within the grid; empty when first >= last.
std::pair<double, double> withinGrid(const Ray& ray, const glm::ivec3& resolution) {
  double first = -1e300, last = 1e300;
  for (int axis = 0; axis < 3; ++axis) {
    const double side = resolution[axis];
    if (ray.direction[axis] == 0.0) {
      if (ray.origin[axis] < 0.0 || ray.origin[axis] >= side) return {0.0, 0.0};
      continue;
    }
    const double low = -ray.origin[axis] / ray.direction[axis],
                 high = (side - ray.origin[axis]) / ray.direction[axis];
    first = std::max(first, std::min(low, high));
    last = std::min(last, std::max(low, high));
  }
  return {first, last};
}

/// What one ray meets, in order: parts of the ray from `enter` to `leave`.
struct Interval {
  double enter, leave;
};
struct Met {
  std::vector<Interval> runs;      ///< of consecutive possible voxels, with a certain one among them
  std::vector<Interval> occupied;  ///< single voxels
  bool inRun = false;              ///< the last voxel was possible
  bool isCertain = false;          ///< and one of its run is certain
  Interval current{0.0, 0.0};

  void voxel(const Interval& part, bool possible, bool certain, bool isOccupied) {
    if (isOccupied) occupied.push_back(part);
    if (!possible) return endRun();
    if (!inRun) current = part;
    current.leave = part.leave;
    isCertain = isCertain || certain;
    inRun = true;
  }
  void endRun() {
    if (inRun && isCertain) runs.push_back(current);
    inRun = isCertain = false;
  }
  void addTo(Crossings& crossings) const {
    auto near = occupied.begin();
    for (const Interval& run : runs) {
      while (near != occupied.end() && near->leave < run.enter - kHoleReach) ++near;
      ++crossings.all;
      if (near == occupied.end() || near->enter > run.leave + kHoleReach) ++crossings.holes;
    }
  }
};

/// Amanatides & Woo 1987, "A fast voxel traversal algorithm for ray tracing".
void walk(const Ray& ray, const VoxelSet& occupied, const VoxelTruth& truth, Crossings& crossings) {
  const VoxelSet& possible = truth.possible;
  const auto [first, last] = withinGrid(ray, possible.resolution());
  if (!(first < last)) return;
  const glm::ivec3 most = possible.resolution() - 1;
  glm::ivec3 voxel, step(0);
  glm::dvec3 next(1e300), stride(1e300);
  const glm::dvec3 start = ray.origin + first * ray.direction;
  for (int axis = 0; axis < 3; ++axis) {
    voxel[axis] = std::clamp(static_cast<int>(std::floor(start[axis])), 0, most[axis]);
    if (ray.direction[axis] == 0.0) continue;
    step[axis] = ray.direction[axis] > 0.0 ? 1 : -1;
    stride[axis] = 1.0 / std::abs(ray.direction[axis]);
    next[axis] = (voxel[axis] + (step[axis] > 0 ? 1 : 0) - ray.origin[axis]) / ray.direction[axis];
  }
  Met met;
  double enter = first;
  while (possible.inside(voxel)) {
    const int axis = next.x <= next.y && next.x <= next.z ? 0 : next.y <= next.z ? 1 : 2;
    const double leave = std::min(next[axis], last);
    met.voxel({enter, leave}, possible.contains(voxel), truth.certain.contains(voxel),
              occupied.contains(voxel));
    enter = leave;
    voxel[axis] += step[axis];
    next[axis] += stride[axis];
  }
  met.endRun();
  met.addTo(crossings);
}

/// Evenly over the lines that meet the grid's bounding sphere: directions over the sphere, places over the
/// disc across them.
Ray obliqueRay(int index, const glm::ivec3& resolution) {
  const auto [u, v, s, t] = r4Point(index);
  const double cosine = 1.0 - 2.0 * u, sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine)),
               around = glm::two_pi<double>() * v;
  const glm::dvec3 direction(sine * std::cos(around), sine * std::sin(around), cosine);
  const glm::dvec3 helper = std::abs(cosine) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
  const glm::dvec3 across = glm::normalize(glm::cross(direction, helper)),
                   other = glm::cross(direction, across);
  const glm::dvec3 side(resolution);
  const double radius = 0.5 * glm::length(side) * std::sqrt(s), angle = glm::two_pi<double>() * t;
  return {0.5 * side + radius * (std::cos(angle) * across + std::sin(angle) * other), direction};
}

template <class RayOf>
Crossings crossingsOf(std::int64_t rays, const VoxelSet& occupied, const VoxelTruth& truth,
                      const RayOf& rayOf) {
  constexpr std::int64_t kGrain = 256;  // rays that one task takes at a time
  return tbb::parallel_reduce(
      tbb::blocked_range<std::int64_t>(0, rays, kGrain), Crossings{},
      [&](const auto& range, Crossings sum) {
        for (std::int64_t i = range.begin(); i != range.end(); ++i) walk(rayOf(i), occupied, truth, sum);
        return sum;
      },
      [](const Crossings& a, const Crossings& b) {
        return Crossings{a.all + b.all, a.holes + b.holes};
      });
}

double share(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace

double RayHoles::axisShare() const {
  return share(axisHoles, axisCrossings);
}
double RayHoles::obliqueShare() const {
  return share(obliqueHoles, obliqueCrossings);
}

RayHoles rayHoles(const VoxelSet& occupied, const VoxelTruth& truth, int raysPerKind) {
  measure::requireSameResolution(occupied, truth.certain);
  measure::requireSameResolution(occupied, truth.possible);
  const glm::ivec3& resolution = truth.possible.resolution();
  RayHoles holes;
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const std::int64_t columns = static_cast<std::int64_t>(resolution[u]) * resolution[v];
    const std::int64_t rays = std::min<std::int64_t>(columns, raysPerKind);
    const Crossings crossings = crossingsOf(rays, occupied, truth, [&](std::int64_t index) {
      const std::int64_t column = index * columns / rays;
      Ray ray{glm::dvec3(0.0), glm::dvec3(0.0)};
      ray.direction[axis] = 1.0;
      ray.origin[u] = static_cast<double>(column % resolution[u]) + 0.5;
      ray.origin[v] = static_cast<double>(column / resolution[u]) + 0.5;
      return ray;
    });
    holes.axisCrossings += crossings.all;
    holes.axisHoles += crossings.holes;
  }
  const Crossings oblique = crossingsOf(raysPerKind, occupied, truth, [&](std::int64_t index) {
    return obliqueRay(static_cast<int>(index), resolution);
  });
  holes.obliqueCrossings = oblique.all;
  holes.obliqueHoles = oblique.holes;
  return holes;
}

}  // namespace lumivox
