// Directions in the bins of a cube: 6 x N x N of them, aligned with the axes of the world (Dong, Kautz,
// Theobalt and Seidel 2007, Sec. 4.2.2). shaders/implicit_visibility/links/direction_bins.glsl has the same
// for shaders; a test compares them.
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
  /// Any length above 0. Of components of equal size the earlier axis counts.
  std::uint32_t binOf(const glm::vec3& direction) const;
  std::uint32_t opposite(std::uint32_t bin) const {
    return bin % (2u * perFace()) < perFace() ? bin + perFace() : bin - perFace();
  }
  /// Unit length.
  glm::vec3 centre(std::uint32_t bin) const;
  /// sr; those of all bins sum to 4 pi.
  float solidAngle(std::uint32_t bin) const;

  /// Where line i of a face lies, i in 0 .. side, as the ratio of components: -1 to 1.
  double border(double i) const;
  /// Inverse of border(), not clamped to 0 .. side.
  double lineAt(double ratio) const;

 private:
  int side_;
  BinMapping mapping_;
};

/// What is wanted of all bins again and again.
struct BinTable {
  std::vector<glm::vec4> bins;  ///< xyz centre, unit length; w solid angle, sr

  explicit BinTable(const DirectionBins& directions);
  /// The projected solid angle of a bin above a plane is taken as its solid angle times the cosine of its
  /// centre, times this factor, which makes the sum over the bins on that side of the plane pi. The same for
  /// both sides. `normal` of unit length; 0 for another one.
  float projectionScale(const glm::vec3& normal) const;
};

}  // namespace lumivox::implicit_visibility
