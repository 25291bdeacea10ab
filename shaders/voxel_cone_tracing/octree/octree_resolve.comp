#version 450
// Integer sums to the bricks of the leaves: radiance pre-multiplied by opacity, and opacity; resolve.comp says how.
//
// As in a grid and at corners: each brick gets the eight voxels that are its own; those that it may share with the neighbour above are copied
// from there (octree_transfer.comp). Voxels in leaves: each vertex is the mean of the voxels of its own leaf around it (thesis 004, Sec. 4.2.2, Fig. 69:
// averages are stored in the corners of the brick, Listing 4.23, and spread through it), and of what the neighbours find once they are
// averaged.
//
// CHANGED: what has not changed since static geometry was lit is copied from there, a brick by one thread.
// DIRECTIONS: the six faces of each voxel, which is one of its leaf's own.
#pragma lumivox axis CHANGED 0 1
#pragma lumivox axis DIRECTIONS 0 1
layout(local_size_x = 64) in;
#include "../bricks.glsl"
#include "common/integer_mean.glsl"
#include "octree_levels.glsl"
#if CHANGED
#include "toolkit/changed_cells.glsl"
#include "octree_still.glsl"
#endif

layout(std140, binding = 0) uniform Leaves {
  float unit;       // W/(sr m^2) that the value 1 of the pool stands for
  int coverageSum;  // 1: the coverages of a voxel add up, to 1 at most; 0: their mean
  int inLeaves;     // 1: of voxels
};
layout(binding = 0) uniform writeonly image3D radianceImage;  // of whatever float format the pool has

#if DIRECTIONS
layout(std430, binding = 4) readonly buffer DirectionalSums { VoxelDirections directions[]; };
#include "../face_sums.glsl"
const uint kFaces = kBrickFaces;

vec4 leafVoxel(uint first, ivec3 vertex, uint face) {
  if (any(greaterThan(vertex, ivec3(1)))) return vec4(0.0);
  return faceOf(first + uint(vertex.x | vertex.y << 1 | vertex.z << 2), int(face), coverageSum != 0, unit);
}
#else
layout(std430, binding = 4) readonly buffer Sums { VoxelSums sums[]; };
const uint kFaces = 1u;

vec4 surfacesIn(VoxelSums sum) {
  vec4 value = meanOf(uvec4(sum.red, sum.green, sum.blue, sum.coverage));
  if (coverageSum != 0) {
    // The sums hold means over the fragments; radiance keeps its share of the opacity.
    float opacity = min(value.a * float(sum.fragments), 1.0);
    value = vec4(value.a > 0.0 ? value.rgb * (opacity / value.a) : vec3(0.0), opacity);
  }
  return vec4(value.rgb * (uintBitsToFloat(sum.brightest) / unit), min(value.a, 1.0));
}

vec4 leafVoxel(uint first, ivec3 vertex, uint face) {
  if (inLeaves == 0) return all(lessThan(vertex, ivec3(2))) ? surfacesIn(sums[first + uint(vertex.x | vertex.y << 1 | vertex.z << 2)]) : vec4(0.0);
  vec4 value = vec4(0.0);
  ivec3 low = max(vertex - 1, 0), high = min(vertex, 1), count = high - low + 1;
  for (int z = low.z; z <= high.z; ++z)
    for (int y = low.y; y <= high.y; ++y)
      for (int x = low.x; x <= high.x; ++x) value += surfacesIn(sums[first + uint(x | y << 1 | z << 2)]);
  return value / float(count.x * count.y * count.z);
}
#endif

void main() {
  uint brick, lane;
#if CHANGED
  if (!itemOf(octreeDepth, 1u, brick, lane)) return;
  uint morton = mortonOf(unpackVoxel(octreeBricks[brick].place)), voxels = voxelsOfBrick();
  bool changed = isChanged(morton, octreeDepth);
#else
  if (!itemOf(octreeDepth, voxelsOfBrick(), brick, lane)) return;
  const uint voxels = 1u;
#endif
  uint first = 8u * (brick - octreeLevels[octreeDepth].firstBrick);
  for (uint i = 0u; i < voxels; ++i) {
    ivec3 vertex = voxelOfLane(lane + i);
    for (uint face = 0u; face < kFaces; ++face) {
#if CHANGED
      vec4 value = changed ? leafVoxel(first, vertex, face) : stillVoxel(morton, octreeDepth, vertex, face);
#else
      vec4 value = leafVoxel(first, vertex, face);
#endif
      imageStore(radianceImage, texelOf(kFaces * brick + face) + vertex, value);
    }
  }
}
