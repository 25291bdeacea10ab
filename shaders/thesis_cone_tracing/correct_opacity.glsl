// Listing 4.10: the counter of fragments in the alpha of a voxel gives way to its opacity, which is 1 where anything is. Empty voxels are
// written as well, since the corrected grid is a texture of its own here; as printed only the others are, in place.
layout(std140, binding = 0) uniform Correction {
  ivec3 resolution;
};
layout(binding = 0) uniform usampler3D averages;
layout(binding = 0) uniform writeonly image3D radianceImage;

void correctOpacity(ivec3 voxel) {
  uint average = texelFetch(averages, voxel, 0).r;
  imageStore(radianceImage, voxel, average != 0u ? vec4(unpackUnorm4x8(average).rgb, 1.0) : vec4(0.0));
}
