// Listing 4.10: replaces the counter of fragments in a voxel's alpha by its opacity, 1 in occupied voxels. Deviates: the corrected grid is
// a separate texture, so empty voxels are written as well; as printed, only occupied voxels are written, in place.
layout(std140, binding = 0) uniform Correction {
  ivec3 resolution;
};
layout(binding = 0) uniform usampler3D averages;
layout(binding = 0) uniform writeonly image3D radianceImage;

void correctOpacity(ivec3 voxel) {
  uint average = texelFetch(averages, voxel, 0).r;
  imageStore(radianceImage, voxel, average != 0u ? vec4(unpackUnorm4x8(average).rgb, 1.0) : vec4(0.0));
}
