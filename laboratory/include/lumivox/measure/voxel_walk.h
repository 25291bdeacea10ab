// The voxels that a straight ray meets, in order: the rule that shaders/common/bit_grid.glsl follows too, so
// that both find the same voxel to the bit where their arithmetic is the same.
//
// Lengths are in voxels, from the corner of voxel (0, 0, 0); voxel k holds [k, k + 1). Plane k of axis a is
// crossed at t_a(k) = (k - o_a) * (1 / d_a), always this expression, and never where 1 / d_a is infinite.
// Rounding keeps the order of the planes of an axis; crossings are in the order of (t, then x before y before
// z). A ray begins in the voxel of its origin at t = 0, or, from outside, behind the last of the crossings
// that bring it in (Amanatides & Woo 1987, with the ties decided).
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>
#include <optional>

#include "lumivox/measure/voxels.h"

namespace lumivox {

/// In the arithmetic of Real: float is that of the device.
template <class Real>
class VoxelWalk {
 public:
  using Vector = glm::vec<3, Real>;

  VoxelWalk(const Vector& origin, const Vector& direction, const glm::ivec3& resolution)
      : origin_(origin), direction_(direction), resolution_(resolution) {
    Crossing last{0, -1};
    for (int axis = 0; axis < 3; ++axis) {
      inverse_[axis] = Real(1) / direction[axis];
      moves_[axis] = std::isfinite(inverse_[axis]);
      const Real side = static_cast<Real>(resolution[axis]);
      start_[axis] = static_cast<int>(std::clamp(std::floor(origin[axis]), Real(-1), side));
      if (inGrid(axis, start_[axis])) continue;
      const bool below = start_[axis] < 0;
      if (!moves_[axis] || (direction[axis] > 0) != below) return;  // leads away from the grid
      const Crossing entry{at(axis, below ? 0 : resolution[axis]), axis};
      if (last.axis < 0 || before(last, entry)) last = entry;
    }
    voxel_ = start_;
    if (last.axis >= 0) {
      for (int axis = 0; axis < 3; ++axis)
        voxel_[axis] = axis != last.axis ? cellAt(axis, last) : start_[axis] < 0 ? 0 : resolution[axis] - 1;
      enter_ = last.t;
    }
    inside_ = inGrid(0, voxel_.x) && inGrid(1, voxel_.y) && inGrid(2, voxel_.z);
    findExit();
  }

  bool inside() const { return inside_; }
  const glm::ivec3& voxel() const { return voxel_; }
  /// Where the ray enters the voxel and where it leaves it; it never leaves one when it does not move.
  Real enter() const { return enter_; }
  Real leave() const { return exit_.t; }
  void advance() {
    inside_ = std::isfinite(exit_.t);
    if (!inside_) return;
    voxel_[exit_.axis] += direction_[exit_.axis] > 0 ? 1 : -1;
    inside_ = inGrid(exit_.axis, voxel_[exit_.axis]);
    enter_ = exit_.t;
    findExit();
  }

 private:
  struct Crossing {
    Real t;
    int axis;
  };

  Vector origin_, direction_, inverse_;
  glm::ivec3 resolution_, start_{0}, voxel_{0};
  glm::bvec3 moves_{false};
  bool inside_ = false;
  Real enter_ = 0;
  Crossing exit_{std::numeric_limits<Real>::infinity(), 0};

  bool inGrid(int axis, int cell) const { return cell >= 0 && cell < resolution_[axis]; }
  Real at(int axis, int plane) const { return (static_cast<Real>(plane) - origin_[axis]) * inverse_[axis]; }
  static bool before(const Crossing& a, const Crossing& b) {
    return a.t < b.t || (a.t == b.t && a.axis < b.axis);
  }
  /// The cell along an axis behind a crossing of another one: that of the start, moved by the planes that
  /// were crossed before it.
  int cellAt(int axis, const Crossing& crossing) const {
    int cell = start_[axis];
    if (!moves_[axis]) return cell;
    const auto crossed = [&](int plane) { return before({at(axis, plane), axis}, crossing); };
    if (direction_[axis] > 0)
      while (cell < resolution_[axis] && crossed(cell + 1)) ++cell;
    else
      while (cell >= 0 && crossed(cell)) --cell;
    return cell;
  }
  void findExit() {
    exit_ = {std::numeric_limits<Real>::infinity(), 0};
    for (int axis = 0; axis < 3; ++axis) {
      if (!moves_[axis]) continue;
      const Crossing next{at(axis, voxel_[axis] + (direction_[axis] > 0 ? 1 : 0)), axis};
      if (before(next, exit_)) exit_ = next;
    }
  }
};

struct VoxelHit {
  glm::ivec3 voxel;
  float t;  ///< where the ray enters it; 0 where it begins in it
};

/// The first voxel of a set that a ray meets at `reach` at most, in single precision. The direction need not
/// have unit length: t and `reach` count it.
inline std::optional<VoxelHit> firstVoxel(const VoxelSet& set, const glm::vec3& origin,
                                          const glm::vec3& direction,
                                          float reach = std::numeric_limits<float>::infinity()) {
  for (VoxelWalk<float> walk(origin, direction, set.resolution()); walk.inside() && walk.enter() <= reach;
       walk.advance())
    if (set.contains(walk.voxel())) return VoxelHit{walk.voxel(), walk.enter()};
  return std::nullopt;
}

}  // namespace lumivox
