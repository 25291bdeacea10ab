#version 450
// Carries the parity of one object along its columns and adds the voxels inside to the solid voxels.
// The parity is reset to zero for the next object.
layout(local_size_x = 8, local_size_y = 8) in;

layout(std140, binding = 0) uniform Parameters {
  ivec2 low, size;  // columns of the object
  int depth;        // voxels along z
};
layout(binding = 0, r32ui) uniform uimage3D parity;
layout(binding = 1, r32ui) uniform uimage3D words;

void main() {
  ivec2 place = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(place, size))) return;
  uint inside = 0u;  // all ones after an odd number of crossings
  for (int w = 0; 32 * w < depth; ++w) {
    ivec3 texel = ivec3(low + place, w);
    uint bits = imageLoad(parity, texel).r;
    if (bits != 0u) imageStore(parity, texel, uvec4(0u));
    // Prefix XOR: each bit becomes the parity of itself and all bits before it.
    bits ^= bits << 1;
    bits ^= bits << 2;
    bits ^= bits << 4;
    bits ^= bits << 8;
    bits ^= bits << 16;
    bits ^= inside;
    inside = (bits >> 31) != 0u ? 0xffffffffu : 0u;
    int left = depth - 32 * w;
    if (left < 32) bits &= (1u << left) - 1u;
    if (bits != 0u) imageStore(words, texel, imageLoad(words, texel) | uvec4(bits));
  }
}
