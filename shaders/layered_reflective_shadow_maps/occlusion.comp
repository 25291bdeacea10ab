#version 450
// A level of opacities from the next finer level, by the rules of voxel cone tracing. The finest level is the grid, padded with empty
// voxels at its high ends.
#pragma lumivox axis LEVEL finest coarser
layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(constant_id = 0) const int rule = 0;  // in the order of OcclusionPass::Rule

layout(std140, binding = 0) uniform Parameters {
  ivec3 coarse;   // voxels of the level that is written
  int fineLevel;
  ivec3 fine;     // voxels of the level that is read
};
layout(binding = 0) uniform sampler3D opacity;
layout(binding = 0) uniform writeonly image3D opacityImage;

vec4 finerVoxel(ivec3 at) { return vec4(0.0, 0.0, 0.0, texelFetch(opacity, at, fineLevel).r); }
#include "common/coarser_level.glsl"

void main() {
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(cell, coarse))) return;
#if LEVEL == LEVEL_FINEST
  float value = all(lessThan(cell, fine)) ? finerVoxel(cell).a : 0.0;
#else
  float value = coarserVoxel(cell, coarse, fine, rule).a;
#endif
  imageStore(opacityImage, cell, vec4(value));
}
