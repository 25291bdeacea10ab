// Decides which partly covered voxels have their bit set.
#include "common/random.glsl"

// C++ side: Masks in techniques/voxelization/bits/bit_voxelizer.h.
layout(std140, binding = 1) uniform MaskRule {
  int maskRule;
  uvec2 maskSeed;
};
const float kCoverageRounding = 1e-6;  // of a sum of shares
const int kMasksAny = 0, kMasksHalf = 1, kMasksRandom = 2;

// kMasksRandom sets the bit with a probability equal to the coverage, so that a lattice keeps its mean opacity. The random number belongs
// to the voxel, so that the result does not depend on the order of a list.
bool isSet(ivec3 voxel, float coverage) {
  if (maskRule == kMasksAny) return true;
  if (maskRule == kMasksHalf) return coverage >= 0.5 - kCoverageRounding;
  return coverage > unitInterval(hash4(uvec4(packVoxel(voxel), 0u, maskSeed)).xy).x;
}
