#version 450
// The colours and the normals of fragments, to be averaged in the leaves of an octree as their light is (thesis 004, Sec. 4.2.2): what
// octree_relight.comp lights. Normals as the thesis packs them, half of each plus a half. Counts fragments as inject.comp does.
#pragma lumivox axis WHAT colour normal
#pragma lumivox require PLACES == octree && !CHANGED
layout(local_size_x = 64) in;
#include "common/fragments.glsl"
#include "../bricks.glsl"

layout(std430, binding = 2) writeonly buffer Radiances { float radiances[]; };  // three of each fragment
#include "../sums.glsl"
layout(std430, binding = 4) buffer Sums { VoxelSums sums[]; };

void main() {
  uint index;
  if (!takenFragment(index)) return;
  VoxelFragment fragment = fragments[index];
#if WHAT == WHAT_COLOUR
  vec3 value = vec3(unpackHalf2x16(fragment.albedoRg), unpackHalf2x16(fragment.albedoBCoverage).x);
#else
  vec3 value = 0.5 + 0.5 * unpackNormal(fragment.normal);
#endif
  for (uint channel = 0u; channel < 3u; ++channel) radiances[3u * index + channel] = value[channel];
  uint place = sumsAt(unpackVoxel(fragment.voxel));
  atomicAdd(sums[place].fragments, 1u);
  atomicMax(sums[place].brightest, floatBitsToUint(max(value.r, max(value.g, value.b))));
}
