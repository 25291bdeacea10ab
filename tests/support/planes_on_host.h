// The surface within voxels by planes, made again on the host from a list of fragments: what
// shaders/toolkit/planes*.comp and shaders/common/voxel_planes.glsl do, in double precision and without
// packing.
#pragma once

#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <vector>

#include "lumivox/reference/voxel_transport.h"
#include "support/voxel_fragments.h"

namespace lumivox::test {

class PlanesOnHost {
 public:
  explicit PlanesOnHost(const VoxelFragments& list) : grid_(list.grid) {
    std::map<Cell, std::vector<FragmentData>> voxels;
    for (const FragmentData& fragment : fragmentsOf(list)) {
      const glm::ivec3 cell = fragment.cell();
      voxels[{cell.x, cell.y, cell.z}].push_back(fragment);
    }
    for (const auto& [cell, fragments] : voxels) planes_[cell] = planesOf(fragments);
  }

  /// Where a ray ends within a voxel that it enters.
  std::optional<BoxStop> stop(const BoxHit& hit) const {
    const auto found = planes_.find({hit.voxel.x, hit.voxel.y, hit.voxel.z});
    if (found == planes_.end()) return BoxStop{hit.enter, glm::dvec3(0.0)};
    const double voxel = grid_.voxelSize;
    const glm::dvec3 fromCentre =
        (hit.origin - glm::dvec3(grid_.low)) / voxel - (glm::dvec3(hit.voxel) + 0.5);
    const std::array<Plane, 2>& planes = found->second;
    std::optional<BoxStop> result;
    for (std::size_t i = 0; i < 2; ++i) {
      const Plane &plane = planes[i], &other = planes[1 - i];
      if (!plane.any) continue;
      const double slope = glm::dot(plane.normal, hit.direction / voxel),
                   t = (plane.offset - glm::dot(plane.normal, fromCentre)) / slope;
      const glm::dvec3 place = fromCentre + t * hit.direction / voxel;
      if (!(t >= 0.0 && glm::all(glm::lessThanEqual(glm::abs(place), glm::dvec3(0.5 + kSlack))))) continue;
      // The slack is one in the measure of the sum of the normal's absolute components.
      if (other.any && glm::dot(other.normal, place) > other.offset + kSlack * sumOf(other.normal)) continue;
      const double way = t * glm::length(hit.direction) / voxel;
      if (way < kNoBacks && (slope > 0.0) != plane.turned) continue;
      if (result && result->end <= t) continue;
      result = BoxStop{t, slope > 0.0 ? -plane.normal : plane.normal};
    }
    return result;
  }
  bool has(const glm::ivec3& voxel) const { return planes_.contains({voxel.x, voxel.y, voxel.z}); }

 private:
  static constexpr double kTogether = 0.70710678, kSlack = 1.0 / 16.0, kNoBacks = 0.5;
  struct Plane {
    bool any = false, turned = false;
    glm::dvec3 normal{0.0};
    double offset = 0.0;
  };
  struct Group {
    glm::dvec3 normal{0.0}, place{0.0};
    double count = 0.0;
  };

  static double sumOf(const glm::dvec3& normal) {
    const glm::dvec3 sides = glm::abs(normal);
    return sides.x + sides.y + sides.z;
  }
  static glm::dvec3 normalOf(std::uint32_t packed) {
    FragmentData fragment{};
    fragment.normal = packed;
    return fragment.unitNormal();
  }

  static std::array<Plane, 2> planesOf(const std::vector<FragmentData>& fragments) {
    std::uint32_t first = 1, second = 0;
    for (const FragmentData& fragment : fragments) first = std::max(first, fragment.normal);
    for (const FragmentData& fragment : fragments) {
      const double agreement = glm::dot(normalOf(fragment.normal), normalOf(first));
      if (agreement >= kTogether) continue;
      second =
          std::max(second, std::max(fragment.normal >> 1, 1u) | (agreement > -kTogether ? 0x80000000u : 0u));
    }
    std::array<Group, 2> groups;
    for (const FragmentData& fragment : fragments) {
      glm::dvec3 normal = normalOf(fragment.normal);
      const std::array<double, 2> agreement{glm::dot(normal, normalOf(first)),
                                            second != 0 ? glm::dot(normal, normalOf(second << 1)) : 0.0};
      const bool about = std::max(agreement[0], agreement[1]) >= kTogether;
      const auto closeness = [&](std::size_t i) { return about ? agreement[i] : std::abs(agreement[i]); };
      const std::size_t group = closeness(0) >= closeness(1) ? 0 : 1;
      if (agreement[group] < 0.0) normal = -normal;
      groups[group].normal += normal;
      groups[group].place += fragment.position() - glm::dvec3(fragment.cell()) - 0.5;
      groups[group].count += 1.0;
    }
    return {planeOf(groups[0], groups[1]), planeOf(groups[1], groups[0])};
  }
  static Plane planeOf(const Group& group, const Group& other) {
    if (group.count == 0.0 || group.normal == glm::dvec3(0.0)) return {};
    Plane plane{true, false, glm::normalize(group.normal), 0.0};
    plane.offset = glm::dot(plane.normal, group.place / group.count);
    if (other.count > 0.0 && glm::dot(plane.normal, other.place / other.count) > plane.offset) {
      plane.normal = -plane.normal, plane.offset = -plane.offset;
      plane.turned = true;
    }
    return plane;
  }

  GridPlacement grid_;
  std::map<Cell, std::array<Plane, 2>> planes_;
};

}  // namespace lumivox::test
