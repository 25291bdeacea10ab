// Traces straight rays through the voxels of a reference and finds the voxels that close the surfaces they
// cross.
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "lumivox/base/low_discrepancy.h"
#include "lumivox/measure/voxel_walk.h"
#include "lumivox/measure/voxels.h"
#include "measure/voxel_resolution.h"

namespace lumivox {
namespace {

struct Ray {
  glm::dvec3 origin, direction;  ///< in voxels; the direction has unit length
};

using Closers = RayCrossings::Closers;

/// A voxel on a ray, from `enter` to `leave`.
struct MetVoxel {
  double enter, leave;
  std::uint64_t bit;
  bool possible, certain;
};

/// Adds the crossings of one ray: runs of consecutive possible voxels that include a certain one, each with
/// the voxels within kHoleReach of it.
void addCrossings(const std::vector<MetVoxel>& met, Closers& closers) {
  std::size_t near = 0;
  for (std::size_t first = 0; first < met.size();) {
    if (!met[first].possible) {
      ++first;
      continue;
    }
    std::size_t end = first;
    bool certain = false;
    for (; end < met.size() && met[end].possible; ++end) certain |= met[end].certain;
    if (certain) {
      const double low = met[first].enter - kHoleReach, high = met[end - 1].leave + kHoleReach;
      while (met[near].leave < low) ++near;
      for (std::size_t i = near; i < met.size() && met[i].enter <= high; ++i)
        closers.voxels.push_back(met[i].bit);
      closers.ends.push_back(closers.voxels.size());
    }
    first = end;
  }
}

void walk(const Ray& ray, const VoxelReference& reference, std::vector<MetVoxel>& met, Closers& closers) {
  const VoxelSet& possible = reference.possible;
  met.clear();
  for (VoxelWalk<double> steps(ray.origin, ray.direction, possible.resolution()); steps.inside();
       steps.advance()) {
    const std::uint64_t bit = possible.bitOf(steps.voxel());
    met.push_back(
        {steps.enter(), steps.leave(), bit, possible.containsBit(bit), reference.certain.containsBit(bit)});
  }
  addCrossings(met, closers);
}

/// Rays evenly distributed over the lines through the grid's bounding sphere: directions over the sphere,
/// places over the perpendicular disc. They start outside of the sphere.
Ray obliqueRay(int index, const glm::ivec3& resolution) {
  const auto [u, v, s, t] = r4Point(index);
  const double cosine = 1.0 - 2.0 * u, sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine)),
               around = glm::two_pi<double>() * v;
  const glm::dvec3 direction(sine * std::cos(around), sine * std::sin(around), cosine);
  const glm::dvec3 helper = std::abs(cosine) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
  const glm::dvec3 across = glm::normalize(glm::cross(direction, helper)),
                   other = glm::cross(direction, across);
  const glm::dvec3 side(resolution);
  const double sphere = 0.5 * glm::length(side), radius = sphere * std::sqrt(s),
               angle = glm::two_pi<double>() * t;
  return {
      0.5 * side - 2.0 * sphere * direction + radius * (std::cos(angle) * across + std::sin(angle) * other),
      direction};
}

template <class RayOf>
void addRays(std::int64_t rays, const VoxelReference& reference, Closers& all, const RayOf& rayOf) {
  constexpr std::int64_t kGrain = 256;  // rays that one task takes at a time
  Closers found = tbb::parallel_reduce(
      tbb::blocked_range<std::int64_t>(0, rays, kGrain), Closers{},
      [&](const auto& range, Closers closers) {
        std::vector<MetVoxel> met;
        for (std::int64_t i = range.begin(); i != range.end(); ++i) walk(rayOf(i), reference, met, closers);
        return closers;
      },
      [](Closers a, const Closers& b) {
        for (const std::uint64_t end : b.ends) a.ends.push_back(a.voxels.size() + end);
        a.voxels.insert(a.voxels.end(), b.voxels.begin(), b.voxels.end());
        return a;
      });
  for (const std::uint64_t end : found.ends) all.ends.push_back(all.voxels.size() + end);
  all.voxels.insert(all.voxels.end(), found.voxels.begin(), found.voxels.end());
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

RayCrossings::RayCrossings(const VoxelReference& reference, int raysPerKind)
    : resolution_(reference.possible.resolution()) {
  measure::requireSameResolution(reference.certain, reference.possible);
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const std::int64_t columns = static_cast<std::int64_t>(resolution_[u]) * resolution_[v];
    const std::int64_t rays = std::min<std::int64_t>(columns, raysPerKind);
    addRays(rays, reference, axis_, [&](std::int64_t index) {
      const std::int64_t column = index * columns / rays;
      Ray ray{glm::dvec3(0.0), glm::dvec3(0.0)};
      ray.direction[axis] = 1.0;
      ray.origin[u] = static_cast<double>(column % resolution_[u]) + 0.5;
      ray.origin[v] = static_cast<double>(column / resolution_[u]) + 0.5;
      return ray;
    });
  }
  addRays(raysPerKind, reference, oblique_,
          [&](std::int64_t index) { return obliqueRay(static_cast<int>(index), resolution_); });
}

std::uint64_t RayCrossings::Closers::holes(const VoxelSet& occupied) const {
  std::uint64_t count = 0, first = 0;
  for (const std::uint64_t end : ends) {
    bool closed = false;
    for (; first < end && !closed; ++first) closed = occupied.containsBit(voxels[first]);
    count += !closed;
    first = end;
  }
  return count;
}

RayHoles RayCrossings::holes(const VoxelSet& occupied) const {
  if (occupied.resolution() != resolution_) measure::refuseResolutions(occupied.resolution(), resolution_);
  return {axis_.ends.size(), axis_.holes(occupied), oblique_.ends.size(), oblique_.holes(occupied)};
}

RayHoles rayHoles(const VoxelSet& occupied, const VoxelReference& reference, int raysPerKind) {
  return RayCrossings(reference, raysPerKind).holes(occupied);
}

}  // namespace lumivox
