// The part of a triangle in a voxel that a cut-out mask leaves.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <vector>

#include "lumivox/measure/voxels.h"

namespace lumivox::measure {

class MaskedTriangle {
 public:
  /// Corners in voxels; texture coordinates with (0,0) at the lower left, repeating.
  MaskedTriangle(const ExactTriangle& triangle, const std::array<glm::vec2, 3>& texcoords,
                 const SurfaceTexture& mask);

  struct Within {
    bool solid = false;  ///< the filtered mask is at least 0.5 at some point of the surface in the voxel
    bool reachesSolid = false;  ///< a texel that filtering reaches from there is at least 0.5
  };
  /// The mask of the triangle within the voxel, grown by `tolerance` on every side.
  Within within(const glm::ivec3& voxel, double tolerance) const;

 private:
  /// A point of the triangle: its place in voxels and in texels.
  struct Point {
    glm::dvec3 position;
    glm::dvec2 texel;
  };
  std::vector<Point> clipped(const glm::dvec3& low, const glm::dvec3& high) const;
  float texel(int x, int y) const;
  float filtered(const glm::dvec2& at) const;
  bool anySolid() const;

  std::array<Point, 3> corners_;
  const SurfaceTexture& mask_;
};

}  // namespace lumivox::measure
