#version 450
// Integer sums to the finest level of the grid: radiance pre-multiplied by opacity, and opacity.
// An occupied voxel is opaque as far as its fragments cover (thesis 004 Listing 4.10: fully).

layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(std140, binding = 0) uniform Parameters {
  ivec3 resolution;
  float radianceRange;
};
layout(std430, binding = 3) readonly buffer Sums { uint sums[]; };
layout(binding = 0) uniform writeonly image3D radianceImage;  // of whatever float format the grid has

const float kFixedPoint = 2147483648.0;  // 2^31, as in inject.comp

void main() {
  ivec3 voxel = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(voxel, resolution))) return;
  uint cell = uint((voxel.z * resolution.y + voxel.y) * resolution.x + voxel.x);
  uvec4 sum = uvec4(sums[4u * cell], sums[4u * cell + 1u], sums[4u * cell + 2u], sums[4u * cell + 3u]);
  vec4 value = vec4(sum) / kFixedPoint;
  imageStore(radianceImage, voxel, vec4(value.rgb * radianceRange, min(value.a, 1.0)));
}
