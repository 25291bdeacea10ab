// Rays through bits, as every pass that sends some takes them. GLSL side: shaders/common/bit_grid.glsl and
// shaders/near_field_voxels/grid.glsl.
#pragma once

#include <cstdint>

#include "lumivox/plugin/technique.h"
#include "lumivox/toolkit/bindings.h"

namespace lumivox::near_field_voxels {

/// In the order of BIT_RULE in bit_grid.glsl.
enum class Method { hierarchy, stacks, plain, printed };

/// How rays find their first voxel: members of a pass.
class RayMethod {
 public:
  explicit RayMethod(Pass* pass);
  /// Value of the axis BIT_RULE.
  int axis() const { return static_cast<int>(static_cast<Method>(method_)); }
  /// The grid with its bits. Error where they do not fit the method.
  shader::BindingSet binding(PassContext& frame, const BinaryGrid& bits) const;
  /// A bound for the turns of all loops of one ray.
  std::int64_t turns(const BinaryGrid& bits) const;

 private:
  Param<Method> method_;
  Param<int> steps_;
  Param<float> behind_;
};

void addProbe(TechniqueRegistry& registry);
void addGather(TechniqueRegistry& registry);

}  // namespace lumivox::near_field_voxels
