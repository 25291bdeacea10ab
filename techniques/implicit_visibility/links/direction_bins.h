// Bins of directions on a cube: 6 x N x N of them, aligned with the world's axes (Dong, Kautz, Theobalt and
// Seidel 2007, Sec. 4.2.2). Their GLSL side is shaders/implicit_visibility/links/direction_bins.glsl; a test
// compares the two.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace lumivox::implicit_visibility {

/// even: borders at equal angles as seen along the middle of a face (the tangent of equal steps), so that
/// bins have nearly the same solid angle. uniform: borders at equal steps on the face, as published; bins at
/// corners are small.
enum class BinMapping { even, uniform };

/// Bin (i, j) of a face is i + N j + N^2 face. Face 2k looks along axis k, face 2k + 1 against it; on both
/// i counts along the ratio of component k + 1 to component k of the direction, and j along that of component
/// k + 2 (modulo 3), so that opposite directions have the same i and j on opposite faces.
class DirectionBins {
 public:
  DirectionBins(int side, BinMapping mapping) : side_(side), mapping_(mapping) {}

  int side() const { return side_; }
  BinMapping mapping() const { return mapping_; }
  std::uint32_t count() const { return 6u * perFace(); }
  std::uint32_t perFace() const { return static_cast<std::uint32_t>(side_ * side_); }
  /// The direction may have any length above 0. Among components of equal size the earlier axis counts.
  std::uint32_t binOf(const glm::vec3& direction) const;
  std::uint32_t opposite(std::uint32_t bin) const {
    return bin % (2u * perFace()) < perFace() ? bin + perFace() : bin - perFace();
  }
  /// Unit length.
  glm::vec3 centre(std::uint32_t bin) const;
  /// sr; those of all bins sum to 4 pi.
  float solidAngle(std::uint32_t bin) const;

  /// Position of line i of a face, i in 0 .. side, as a ratio of components from -1 to 1.
  double border(double i) const;
  /// Inverse of border(), not clamped to 0 .. side.
  double lineAt(double ratio) const;

 private:
  int side_;
  BinMapping mapping_;
};

/// Tables of all bins.
struct BinTable {
  std::vector<glm::vec4> bins;  ///< xyz centre, unit length; w solid angle, sr

  explicit BinTable(const DirectionBins& directions);
  /// Factor for the projected solid angles of bins above a plane, each taken as solid angle times cosine of
  /// the centre: with it they sum to pi. It is the same for both sides. `normal` has unit length; otherwise
  /// the result is 0.
  float projectionScale(const glm::vec3& normal) const;
};

}  // namespace lumivox::implicit_visibility
