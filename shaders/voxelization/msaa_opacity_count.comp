#version 450
// The opacity of a voxel from the bit counts of its sides (thesis 004 Sec. 3.5.2).
layout(local_size_x = 32, local_size_y = 2) in;  // rows of a volume are contiguous in memory

layout(std140, binding = 0) uniform Sides {
  int sampleCount;
  int side;  // 0, 1, 2: across x, y, z; 3: the most opaque of them
};
layout(binding = 0, r32ui) uniform readonly uimage3D sampleMasks;
layout(binding = 1, r8) uniform writeonly image3D opacity;

void main() {
  ivec3 voxel = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(voxel, imageSize(opacity)))) return;
  uint masks = imageLoad(sampleMasks, voxel).r;
  vec3 shares = vec3(bitCount(masks & 255u), bitCount(masks >> 8 & 255u), bitCount(masks >> 16 & 255u)) / float(sampleCount);
  imageStore(opacity, voxel, vec4(side < 3 ? shares[side] : max(shares.x, max(shares.y, shares.z))));
}
