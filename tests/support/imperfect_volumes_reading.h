// A surface point's read of the volume (Eq. 5, 'voxels six' or 'eight'), implemented again on the host in
// double precision.
#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "lumivox/measure/voxels.h"

namespace lumivox::test::volumes {

class ReadingOnHost {
 public:
  struct Choice {
    bool six = true;       ///< else eight
    bool filtered = true;  ///< neighbours are positions that are interpolated trilinearly; else whole voxels
    bool free = true;      ///< only voxels that are free and open to the surface count, if there are any
    double shift = 0.5;    ///< voxels
  };
  struct Share {
    glm::ivec3 voxel;
    double weight;
  };

  /// `normals`: rgba of the mean normals, x fastest.
  ReadingOnHost(const VoxelSet& occupied, const std::vector<float>& normals, const Choice& choice)
      : occupied_(occupied), normals_(normals), choice_(choice) {}

  /// The voxels that a surface point reads, without duplicates. The weights sum to 1. Lengths are in voxels.
  std::vector<Share> sharesAt(const glm::dvec3& surface, const glm::dvec3& normal) const {
    std::vector<Share> shares;
    const std::optional<glm::ivec3> before =
        choice_.free ? voxelBefore(surface, normal) : std::optional<glm::ivec3>{};
    if (before) shares = counted(surface, normal, [&](const glm::ivec3& v) { return isOpen(v, *before); });
    if (shares.empty()) shares = counted(surface, normal, [](const glm::ivec3&) { return true; });
    return shares;
  }

 private:
  const VoxelSet& occupied_;
  const std::vector<float>& normals_;
  Choice choice_;

  glm::ivec3 clamped(const glm::dvec3& voxel) const {
    return glm::clamp(glm::ivec3(voxel), glm::ivec3(0), occupied_.resolution() - 1);
  }

  /// The neighbours' positions with positive cosines to the normal, and these cosines.
  std::vector<std::pair<glm::dvec3, double>> neighbours(const glm::dvec3& surface,
                                                        const glm::dvec3& normal) const {
    const glm::dvec3 shifted = surface + choice_.shift * normal;
    std::vector<glm::dvec3> places;
    if (choice_.six) {
      const glm::dvec3 middle = choice_.filtered ? shifted : glm::floor(shifted) + 0.5;
      for (int axis = 0; axis < 3; ++axis)
        for (const double way : {-1.0, 1.0}) {
          places.push_back(middle);
          places.back()[axis] += way;
        }
    } else {
      const glm::dvec3 low = choice_.filtered ? shifted - 0.5 : glm::floor(shifted - 0.5) + 0.5;
      for (int i = 0; i < 8; ++i) places.push_back(low + glm::dvec3(i & 1, i >> 1 & 1, i >> 2));
    }
    std::vector<std::pair<glm::dvec3, double>> result;
    for (const glm::dvec3& place : places)
      if (const double cosine = glm::dot(normal, glm::normalize(place - surface)); cosine > 0.0)
        result.emplace_back(place, cosine);
    return result;
  }

  template <class Counts>
  std::vector<Share> counted(const glm::dvec3& surface, const glm::dvec3& normal,
                             const Counts& counts) const {
    std::map<std::uint64_t, double> weights;
    double all = 0.0;
    const auto add = [&](const glm::dvec3& voxel, double weight) {
      const glm::ivec3 own = clamped(voxel);
      if (!counts(own)) return;
      weights[occupied_.bitOf(own)] += weight;
      all += weight;
    };
    for (const auto& [place, cosine] : neighbours(surface, normal)) {
      if (!choice_.filtered) {
        add(glm::floor(place), cosine);
        continue;
      }
      const glm::dvec3 low = glm::floor(place - 0.5), part = place - 0.5 - low;
      for (const int x : {0, 1})
        for (const int y : {0, 1})
          for (const int z : {0, 1})
            add(low + glm::dvec3(x, y, z), cosine * (x == 1 ? part.x : 1.0 - part.x) *
                                               (y == 1 ? part.y : 1.0 - part.y) *
                                               (z == 1 ? part.z : 1.0 - part.z));
    }
    std::vector<Share> result;
    if (all > 0.0)
      for (const auto& [bit, weight] : weights) result.push_back({occupied_.voxelOf(bit), weight / all});
    return result;
  }

  /// The voxel in front of the surface: its own voxel if that is free, else the free neighbour whose
  /// direction is closest to the mean of the surface's normal and the voxel's mean normal.
  std::optional<glm::ivec3> voxelBefore(const glm::dvec3& surface, const glm::dvec3& normal) const {
    const glm::ivec3 own = clamped(glm::floor(surface));
    if (!occupied_.contains(own)) return own;
    const std::size_t i = 4 * occupied_.bitOf(own);
    const glm::dvec3 mean(normals_[i], normals_[i + 1], normals_[i + 2]);
    glm::dvec3 along = normal;
    if (glm::length(mean) > 1.0 / 64.0)
      along = glm::normalize(normal + (glm::dot(mean, normal) < 0.0 ? -1.0 : 1.0) * glm::normalize(mean));
    std::optional<glm::ivec3> found;
    double most = 0.0;
    for (int z = -1; z <= 1; ++z)
      for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x) {
          const glm::ivec3 way(x, y, z), voxel = own + way;
          if (way == glm::ivec3(0) || !occupied_.inside(voxel) || occupied_.contains(voxel)) continue;
          // The margin keeps the first of those that are equal up to rounding.
          const double cosine = glm::dot(along, glm::normalize(glm::dvec3(way)));
          if (cosine <= most + 1e-3) continue;
          most = cosine;
          found = voxel;
        }
    return found;
  }

  /// Whether the voxel is free and so are the voxels at 2/5 and 3/5 of the straight line to it.
  bool isOpen(const glm::ivec3& voxel, const glm::ivec3& before) const {
    if (occupied_.contains(voxel)) return false;
    const glm::ivec3 apart = glm::abs(voxel - before);
    if (std::max({apart.x, apart.y, apart.z}) <= 1) return true;
    for (const double share : {0.4, 0.6}) {
      const glm::dvec3 place = glm::dvec3(before) + 0.5 + share * glm::dvec3(voxel - before);
      if (occupied_.contains(clamped(glm::floor(place)))) return false;
    }
    return true;
  }
};

}  // namespace lumivox::test::volumes
