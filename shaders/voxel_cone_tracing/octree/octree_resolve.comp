#version 450
// Writes the bricks of the leaves from the integer sums: radiance pre-multiplied by opacity, and opacity, as resolve.comp does.
//
// CHANGED: bricks that have not changed since static geometry was lit are copied from the static octree, one thread per brick.
// DIRECTIONS: the six faces of each voxel.
// REFLECTED: light of bounces is added to the direct light of the sums.
#pragma lumivox axis CHANGED 0 1
#pragma lumivox axis DIRECTIONS 0 1
#pragma lumivox require !(CHANGED && REFLECTED)
layout(local_size_x = 64) in;
#include "../resolved.glsl"
#include "octree_levels.glsl"
#if CHANGED
#include "toolkit/changed_cells.glsl"
#include "octree_still.glsl"
#endif

layout(std140, binding = 0) uniform Leaves {
  float unit;       // radiance of the value 1 of the pool, W/(sr m^2)
  int coverageSum;  // opacity of a voxel: 1: the sum of its coverages, at most 1; 0: their mean, with DIRECTIONS the largest
};
layout(binding = 0) uniform writeonly image3D radianceImage;  // of any float format

#if DIRECTIONS
layout(std430, binding = 4) readonly buffer DirectionalSums { VoxelDirections directions[]; };
#include "../face_sums.glsl"
const uint kFaces = kBrickFaces;

vec4 leafVoxel(uint place, uint face) {
  return withReflected(faceOf(place, int(face), coverageSum != 0, unit), kFaces * place + face, unit);
}
#else
layout(std430, binding = 4) readonly buffer Sums { VoxelSums sums[]; };
const uint kFaces = 1u;

vec4 leafVoxel(uint place, uint face) {
  return withReflected(surfacesOf(sums[place], coverageSum != 0, unit), place, unit);
}
#endif

void main() {
  uint brick, lane;
#if CHANGED
  if (!itemOf(octreeDepth, 1u, brick, lane)) return;
  uint morton = mortonOf(unpackVoxel(octreeBricks[brick]));
  const uint kVoxels = kBrickVoxels;
  bool changed = isChanged(morton, octreeDepth);
#else
  if (!itemOf(octreeDepth, kBrickVoxels, brick, lane)) return;
  const uint kVoxels = 1u;
#endif
  uint first = 8u * (brick - octreeLevels[octreeDepth].firstBrick);
  for (uint i = 0u; i < kVoxels; ++i) {
    ivec3 voxel = voxelOfLane(lane + i);
    for (uint face = 0u; face < kFaces; ++face) {
#if CHANGED
      vec4 value = changed ? leafVoxel(first + lane + i, face) : stillVoxel(morton, octreeDepth, voxel, face);
#else
      vec4 value = leafVoxel(first + lane + i, face);
#endif
      imageStore(radianceImage, texelOf(kFaces * brick + face) + voxel, value);
    }
  }
}
