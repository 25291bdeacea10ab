// An environment map on the faces of an octahedron, at several widths, for cones that read the mean radiance
// of their width: Praun and Hoppe 2003, "Spherical parametrization and remeshing"; Engelhardt and Dachsbacher
// 2008, "Octahedron environment maps".
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "lumivox/scene/environment.h"

namespace lumivox {

/// Square levels of texels, each of half the side. A texel is the mean of the map over the directions that it
/// covers, weighted by solid angle; so is a texel of a coarser level, of four finer ones. Directions are
/// those of the world: (x, y) / (|x| + |y| + |z|), folded outwards where z is negative, from -1..1 to
/// 0..side. Shaders read it by shaders/common/environment.glsl.
class OctahedralEnvironment {
 public:
  static constexpr int kLargestSide = 512;

  explicit OctahedralEnvironment(const EnvironmentMap& map);
  int levels() const { return levels_; }
  int side() const { return side_; }  ///< of level 0: texels about as wide as those of the map
  /// All levels, level 0 first; row by row.
  const std::vector<glm::vec3>& radiance() const { return radiance_; }

 private:
  int side_, levels_;
  std::vector<glm::vec3> radiance_;
};

}  // namespace lumivox
