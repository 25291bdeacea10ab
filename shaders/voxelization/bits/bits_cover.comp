#version 450
// Bits decided by the sum of the coverages of a voxel's fragments. One invocation per word.
#include "common/voxel.glsl"
#include "../masks.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0) uniform sampler3D opacity;
layout(binding = 0, r32ui) uniform writeonly uimage3D words;

void main() {
  ivec3 place = ivec3(gl_GlobalInvocationID), size = textureSize(opacity, 0);
  if (any(greaterThanEqual(place, imageSize(words)))) return;
  uint word = 0u;
  for (int bit = 0; bit < 32 && 32 * place.z + bit < size.z; ++bit) {
    ivec3 voxel = ivec3(place.xy, 32 * place.z + bit);
    float covered = texelFetch(opacity, voxel, 0).r;
    if (covered > 0.0 && isSet(voxel, covered)) word |= 1u << bit;
  }
  imageStore(words, place, uvec4(word));
}
