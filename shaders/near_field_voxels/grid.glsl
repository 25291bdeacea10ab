// Where the bits lie. C++ side: RayMethod::binding() in techniques/near_field_voxels/rays.cpp.
#include "common/bit_grid.glsl"

layout(std140, binding = 0) uniform Grid {
  vec3 gridLow;     // m
  float voxelSize;  // m
  ivec3 resolution;
};
