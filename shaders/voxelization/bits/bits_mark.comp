#version 450
// Sets the bits of the voxels of a list of fragments. Each partly covering fragment is tested alone, by a rule that is the same for all
// fragments of a voxel. The fragment with the largest coverage thus decides, and a wall keeps its voxels beside a lattice.

// MOVING: only moving fragments, which follow the static ones in the list; columns that get a bit are marked in `touched`.
#pragma lumivox axis MOVING 0 1

layout(local_size_x = 64) in;
#include "common/fragments.glsl"
#include "../masks.glsl"

layout(binding = 0, r32ui) uniform uimage3D words;
#if MOVING
layout(binding = 1, r32ui) uniform uimage2D touched;
layout(std430, binding = 8) readonly buffer StillFragments { uint stillFragments; };
#endif

void main() {
  uint index = listIndex();
  if (index >= fragmentCount) return;
#if MOVING
  index += stillFragments;
#endif
  VoxelFragment fragment = fragments[index];
  ivec3 voxel = unpackVoxel(fragment.voxel);
  if (!isSet(voxel, unpackHalf2x16(fragment.albedoBCoverage).y)) return;
  imageAtomicOr(words, ivec3(voxel.xy, voxel.z >> 5), 1u << (voxel.z & 31));
#if MOVING
  imageAtomicOr(touched, voxel.xy, 1u);
#endif
}
