#version 450
// A black opaque fragment for every set voxel that has no surface sample: it blocks light and reflects none.
#include "bits.glsl"
#include "../fragment_list.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

void main() {
  ivec3 place = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(place, imageSize(words)))) return;
  uint bits = imageLoad(words, place).r & ~surfaceWordAt(place);
  if (bits == 0u) return;
  uint index = atomicAdd(fragmentCount, uint(bitCount(bits)));
  VoxelFragment fragment;
  fragment.offset = packOffset(vec3(0.5));
  fragment.normal = packNormal(vec3(0.0, 1.0, 0.0));
  fragment.albedoRg = 0u;
  fragment.albedoBCoverage = packHalves(vec2(0.0, 1.0));
  fragment.emission = 0u;
  for (; bits != 0u; bits &= bits - 1u, ++index) {
    if (index >= uint(capacity)) return;
    fragment.voxel = packVoxel(ivec3(place.xy, 32 * place.z + findLSB(bits)));
    fragments[index] = fragment;
  }
}
