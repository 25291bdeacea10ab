// Rays through one bit a voxel, and the light of reflective shadow maps where they end: what the passes that
// send such rays have in common (Thiedemann et al. 2011, Sec. 4 and 5; thesis Gomes 2015, Sec. 3.2).
// GLSL side: shaders/common/bit_rays.glsl and back_projection.glsl.
#pragma once

#include <cstdint>
#include <string>

#include "lumivox/pipeline/pass.h"
#include "lumivox/pipeline/ports/binary_grid.h"
#include "lumivox/pipeline/ports/reflective_shadow_map.h"

namespace lumivox {

/// How rays find their first voxel: a parameter of a pass.
class RayMethod {
 public:
  /// In the order of BIT_RULE in bit_grid.glsl.
  enum class Method { hierarchy, stacks, plain, printed };

  explicit RayMethod(Pass* pass);
  /// Value of the axis BIT_RULE.
  int axis() const { return static_cast<int>(static_cast<Method>(method_)); }
  std::string name() const { return method_.valueText(); }
  /// The grid with its bits. Error where they do not fit the method.
  shader::BindingSet binding(PassContext& frame, const BinaryGrid& bits) const;
  /// A bound for the turns of all loops of one ray.
  std::int64_t turns(const BinaryGrid& bits) const;

 private:
  Param<Method> method_;
  Param<int> steps_;
  Param<float> behind_;
};

/// Which texels of a reflective shadow map show the surface at a point: parameters of a pass.
class BackProjection {
 public:
  explicit BackProjection(Pass* pass);
  /// What is wrong with the parameters, in words, or empty.
  std::string check() const;
  /// The rule, for light samples from `first` on. `printed`: cosines to the light as Listing 4.49 bounds
  /// them.
  shader::BindingSet binding(float voxelSize, bool printed, int first, int count) const;
  int taps() const { return taps_; }
  bool front() const { return front_; }

 private:
  Param<int> taps_;
  Param<float> tolerance_, cap_;
  Param<bool> front_;
};

/// Error where a map does not hold as many lights, views and layers as it tells of. `pass`: whose input it
/// is.
void requireWhole(const ReflectiveShadowMap& map, const std::string& pass);

}  // namespace lumivox
