// The values of a field of voxels, stored in textures, in stacks of bits, or in a volume in which the items of a list were marked.
// C++ side: VoxelField in framework/include/lumivox/toolkit/voxel_view.h.
#ifndef LUMIVOX_VOXEL_FIELD
#define LUMIVOX_VOXEL_FIELD
#pragma lumivox axis SOURCE texels stacks marks

layout(std140, binding = 1) uniform FieldParameters {
  vec3 gridLow;          // corner of voxel (0,0,0), m
  float fieldUnit;       // physical value of the number 1
  vec3 voxelSides;       // m
  int fieldLevel;        // of the textures
  ivec3 gridResolution;
  int fieldChannels;     // of a value: 1 or 3
  ivec3 textureOf;       // texture of each channel; componentOf: its component
  int marksCount;        // 1: marks are numbers of items; 0: bits, 32 voxels along z per word
  ivec3 componentOf;
};
float shortestSide() { return min(voxelSides.x, min(voxelSides.y, voxelSides.z)); }

#if SOURCE == SOURCE_TEXELS
layout(binding = 0) uniform sampler3D field0;
layout(binding = 1) uniform sampler3D field1;
layout(binding = 2) uniform sampler3D field2;

vec4 texelOf(int which, ivec3 voxel) {
  if (which == 0) return texelFetch(field0, voxel, fieldLevel);
  if (which == 1) return texelFetch(field1, voxel, fieldLevel);
  return texelFetch(field2, voxel, fieldLevel);
}
#elif SOURCE == SOURCE_STACKS
layout(binding = 0) uniform usampler2DArray fieldStacks;
const int kStack = 128;  // voxels in a texel: BinaryGrid
#else
layout(binding = 0) uniform usampler3D fieldMarks;
#endif

// A field of one channel has its value in all three components.
vec3 fieldValue(ivec3 voxel) {
#if SOURCE == SOURCE_TEXELS
  vec3 value = vec3(texelOf(textureOf.x, voxel)[componentOf.x]);
  if (fieldChannels == 3) {
    value.y = texelOf(textureOf.y, voxel)[componentOf.y];
    value.z = texelOf(textureOf.z, voxel)[componentOf.z];
  }
  return value * fieldUnit;
#elif SOURCE == SOURCE_STACKS
  uvec4 words = texelFetch(fieldStacks, ivec3(voxel.xy, voxel.z / kStack), fieldLevel);
  return vec3(words[voxel.z % kStack / 32] >> uint(voxel.z % 32) & 1u);
#else
  if (marksCount != 0) return vec3(texelFetch(fieldMarks, voxel, 0).r);
  return vec3(texelFetch(fieldMarks, ivec3(voxel.xy, voxel.z / 32), 0).r >> uint(voxel.z % 32) & 1u);
#endif
}

#endif
