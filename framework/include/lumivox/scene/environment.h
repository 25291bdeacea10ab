// Light from beyond the scene that differs by direction: an image of the whole sphere, in latitude and
// longitude.
//
// Convention: row 0 is the zenith (+Y) and the last row the nadir. The middle column looks along -Z, as a
// camera at rest does; to its right lies +X, to its left -X, and the left and the right edge meet at +Z. With
// u to the right and v down, both from 0 to 1, the direction is
//   (sin(pi v) sin(2 pi (u - 1/2)), cos(pi v), -sin(pi v) cos(2 pi (u - 1/2))).
// Radiance is constant within a texel, whose solid angle is 2 pi / width (cos(top) - cos(bottom)).
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <vector>

#include "lumivox/base/hash.h"

namespace lumivox {

struct EnvironmentMap {
  int width = 0, height = 0;
  std::vector<glm::vec3> radiance;  ///< W/(sr m^2), finite and not negative; row by row from the zenith
  glm::mat3 toMap{1.0f};            ///< from world directions to those of the convention: a rotation
  glm::vec3 brightest{0.0f};        ///< largest radiance of each channel; finish() sets it
  ContentHash hash;                 ///< of everything above; finish() sets it
  void finish();
  bool operator==(const EnvironmentMap& other) const { return hash == other.hash; }

  /// The texel in this direction of the world (not zero, of any length): its index in `radiance`.
  std::size_t texelTowards(const glm::vec3& direction) const;
  const glm::vec3& towards(const glm::vec3& direction) const { return radiance[texelTowards(direction)]; }
  /// The direction of the world at a point of the image, column and row in texels from the upper left corner.
  glm::vec3 direction(float column, float row) const;
  /// The direction of the world at (u, v) in [0, 1) of a texel, evenly by solid angle.
  glm::vec3 directionWithin(int column, int row, float u, float v) const;
  /// Solid angle of each texel of a row, sr.
  double solidAngle(int row) const;
  /// Mean radiance over the sphere.
  glm::vec3 mean() const;
};

/// The largest map that is read, in texels: one of 8192 x 4096 takes 384 MiB, and its table for sampling
/// 256 MiB.
constexpr std::size_t kMostEnvironmentTexels = std::size_t{8192} * 4096;

}  // namespace lumivox
