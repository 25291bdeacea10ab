#version 450
// Integer sums to the finest level of the grid: radiance pre-multiplied by opacity, and opacity.
// An occupied voxel is opaque as far as its fragments cover (thesis 004 Listing 4.10: fully).

#include "common/voxel.glsl"

layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(std140, binding = 0) uniform Parameters {
  ivec3 resolution;
  float unit;       // W/(sr m^2) that the value 1 of the grid stands for
  int coverageSum;  // 1: the coverages of a voxel add up, to 1 at most; 0: their mean
};
layout(binding = 0, r32ui) uniform readonly uimage3D counts;
layout(binding = 1, r32ui) uniform readonly uimage3D brightest;
layout(binding = 2, r32ui) uniform readonly uimage3D sumRed;
layout(binding = 3, r32ui) uniform readonly uimage3D sumGreen;
layout(binding = 4, r32ui) uniform readonly uimage3D sumBlue;
layout(binding = 5, r32ui) uniform readonly uimage3D sumCoverage;
layout(binding = 6) uniform writeonly image3D radianceImage;  // of whatever float format the grid has

void main() {
  ivec3 voxel = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(voxel, resolution))) return;
  uvec4 sum = uvec4(imageLoad(sumRed, voxel).r, imageLoad(sumGreen, voxel).r, imageLoad(sumBlue, voxel).r, imageLoad(sumCoverage, voxel).r);
  vec4 value = vec4(sum) / kFixedPoint;
  if (coverageSum != 0) {
    // The sums hold means over the fragments; radiance keeps its share of the opacity.
    float opacity = min(value.a * float(imageLoad(counts, voxel).r), 1.0);
    value = vec4(value.a > 0.0 ? value.rgb * (opacity / value.a) : vec3(0.0), opacity);
  }
  float scale = uintBitsToFloat(imageLoad(brightest, voxel).r) / unit;
  imageStore(radianceImage, voxel, vec4(value.rgb * scale, min(value.a, 1.0)));
}
