// Which voxels with holes have their bit set.
#include "common/random.glsl"

// C++ side: Masks in techniques/voxelization/bits/bit_voxelizer.h.
layout(std140, binding = 1) uniform MaskRule {
  int maskRule;
  uvec2 maskSeed;
};
const int kMasksAny = 0, kMasksHalf = 1, kMasksRandom = 2;

// By chance as often as the voxel is covered: a number of the voxel's own, so that the same ones are set whatever the order of a list, and
// a lattice keeps its mean opacity.
bool isSet(ivec3 voxel, float coverage) {
  if (maskRule == kMasksAny) return true;
  if (maskRule == kMasksHalf) return coverage >= 0.5;
  return coverage > unitInterval(hash4(uvec4(packVoxel(voxel), 0u, maskSeed)).xy).x;
}
