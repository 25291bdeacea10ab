#version 450
// Converts units of particles per voxel to densities.
layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(std140, binding = 0) uniform Parameters {
  ivec3 resolution;
  float densityPerUnit;
};
layout(binding = 0, r32ui) uniform readonly uimage3D lowWords;
layout(binding = 1, r32ui) uniform readonly uimage3D highWords;
layout(binding = 2, r32f) uniform writeonly image3D densityImage;

void main() {
  ivec3 voxel = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(voxel, resolution))) return;
  float units = float(imageLoad(highWords, voxel).r) * 4294967296.0 + float(imageLoad(lowWords, voxel).r);
  imageStore(densityImage, voxel, vec4(units * densityPerUnit));
}
