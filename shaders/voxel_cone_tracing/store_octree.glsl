// A sparse voxel octree: Crassin et al. 2011, Sec. 4 and 7; thesis 004, Sec. 4.2.2, Listing 4.25. Where the tree ends there is nothing, and
// nothing is read.
//
// LOOK_UP: the brick of a node is found from the root, for each of the two levels of a sample, as published; or (ranks) by counting the tags
// before its own, in two reads whatever the depth and without a loop. Bricks have the voxels of their neighbours at their sides, as published,
// or (own) are their own ones alone, and those around a node are known by it.
#pragma lumivox axis LOOK_UP own ranks descent
#pragma lumivox require STORE == octree || LOOK_UP == own
#include "octree.glsl"
#if LOOK_UP == LOOK_UP_OWN
#include "octree_corners.glsl"
#elif LOOK_UP == LOOK_UP_RANKS
#include "octree_ranks.glsl"

uint brickOfNode(ivec3 place, int depth) { return rankedBrick(mortonOf(place), depth); }
#else
uint brickOfNode(ivec3 place, int depth) { return brickAt(place, depth); }
#endif

layout(std140, binding = 4) uniform OctreeStore {
  float firstVoxel;      // the middle of voxel 0 of the finest level, voxels from storeLow
  float firstVoxelGrows; // 1: by as many voxels of every level; 0: it is the same place
};
layout(binding = 4) uniform sampler3D brickPool;

vec2 insideStore(vec3 origin, vec3 direction) { return insideVolume(storeLow, storeExtent, origin, direction); }

float finestVoxel(vec3 at) { return storeVoxel; }

float longestStep(float size) { return kNoLimit; }

// Voxels are filtered here and not by a sampler, whose coordinates are rounded by where in which pool the brick lies: a frame would differ
// from the same frame alone.
#if LOOK_UP == LOOK_UP_OWN
// Of a level, `from` voxels from the middle of its voxel 0. Outside of the grid there is nothing.
vec4 amongVoxels(vec3 from, int depth) {
  vec3 at = clamp(floor(from), vec3(0.0), vec3(float((2 << depth) - 1))), part = clamp(from - at, vec3(-1.0), vec3(1.0));
  ivec3 low = ivec3(at), own = low & 1;
  uint corners = cornersOf(mortonOf(low >> 1), depth);
  if (corners == kNone) return vec4(0.0);
  vec3 weights[2] = vec3[2](1.0 - abs(part), max(part, vec3(0.0)));
  uint crossed = uint(own.x | own.y << 1 | own.z << 2);  // axes along which the higher voxels are in the next brick
  vec4 value = vec4(0.0);
  for (uint i = 0u; i < 8u; ++i) {
    uvec3 corner = uvec3(i & 1u, i >> 1 & 1u, i >> 2);
    uint brick = octreeCorners[corners + (i & crossed)];
    if (brick != kNone)
      value += weights[corner.x].x * weights[corner.y].y * weights[corner.z].z * texelFetch(brickPool, texelOf(brick) + (own ^ ivec3(corner)), 0);
  }
  return value;
}
#else
// In a brick, `at` voxels from its first one along each axis.
vec4 inBrick(uint brick, vec3 at) {
  ivec3 low = min(ivec3(at), ivec3(1)), texel = texelOf(brick) + low;
  vec3 part = at - vec3(low);
  vec4 columns[4];
  for (int i = 0; i < 4; ++i) {
    ivec3 first = texel + ivec3(0, i & 1, i >> 1);
    columns[i] = mix(texelFetch(brickPool, first, 0), texelFetch(brickPool, first + ivec3(1, 0, 0), 0), part.x);
  }
  return mix(mix(columns[0], columns[1], part.y), mix(columns[2], columns[3], part.y), part.z);
}

#endif

// Values of a level around a point, finest voxels from storeLow. False: the tree has no node of that level there. Below its voxel 0 lies one
// with nothing in it.
bool readLevel(vec3 at, int level, out vec4 value) {
  vec3 from = at * exp2(float(-level)) - firstVoxel * (firstVoxelGrows != 0.0 ? 1.0 : exp2(float(-level)));
  int depth = octreeDepth - level;
#if LOOK_UP == LOOK_UP_OWN
  value = amongVoxels(from, depth);
  return value.a > 0.0;
#else
  vec3 inside = clamp(from, vec3(0.0), vec3(float(2 << depth)));
  ivec3 place = min(ivec3(inside) >> 1, ivec3((1 << depth) - 1));
  uint brick = brickOfNode(place, depth);
  vec3 border = clamp(1.0 + from, vec3(0.0), vec3(1.0));
  value = brick == kNone ? vec4(0.0) : border.x * border.y * border.z * inBrick(brick, inside - vec3(2 * place));
  return brick != kNone;
#endif
}

StoreSample readStore(vec3 at, vec3 direction, float size, float stride) {
  float blend, level = levelOf(max(size / storeVoxel, 1.0), storeCoarsest, blend);
  vec3 voxel = (at - storeLow) / storeVoxel;
  vec4 finer, coarser = vec4(0.0);
  readLevel(voxel, int(level), finer);
  if (blend > 0.0) readLevel(voxel, int(level) + 1, coarser);
  StoreSample result = StoreSample(mix(finer, coarser, blend), 0.0);
  if (result.value.a > 0.0) result.opacity = opacityOfStep(result.value.a, stride, level, blend);
  return result;
}

// Listing 4.25 counts levels from the root, so that their fraction is the share of the finer one, and gives it to the coarser; where the
// finer one ends there is nothing.
vec4 readStoreAsPublished(vec3 at, vec3 direction, float size) {
  float coarseness = clamp(log2(size / storeVoxel), 0.0, storeCoarsest), counted = storeCoarsest + 1.0 - coarseness;
  vec3 voxel = (at - storeLow) / storeVoxel;
  vec4 finer, coarser = vec4(0.0);
  if (!readLevel(voxel, int(floor(coarseness)), finer)) return vec4(0.0);
  if (fract(counted) > 0.0) readLevel(voxel, int(floor(coarseness)) + 1, coarser);
  return mix(finer, coarser, fract(counted));
}
