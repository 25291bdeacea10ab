// A sparse voxel octree: Crassin et al. 2011, Sec. 4 and 7; thesis 004, Sec. 4.2.2, Listing 4.25. Where the tree ends there is nothing, and
// nothing is read.
//
// LOOK_UP: the brick of a node is found from the root, for each of the two levels of a sample, as published; or (ranks) by counting the tags
// before its own, in two reads whatever the depth and without a loop. Bricks have the voxels of their neighbours at their sides, as published,
// or (own) are their own ones alone, and those around a node are known by it.
//
// FACES: six: each voxel has six faces, read by the rules of the six directional grids, in bricks of their own voxels.
#pragma lumivox axis LOOK_UP own ranks descent
#pragma lumivox require STORE == octree || LOOK_UP == own
#pragma lumivox axis FACES one six
#pragma lumivox require FACES == one || (STORE == octree && LOOK_UP == own)
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

#if FACES == FACES_SIX
#include "../cones/through_faces.glsl"
// The faces that the cone sees, across x, y and z, and how much of each is to be read.
uvec3 facesSeen;
vec3 shareOfFaces;

void lookAtFaces(vec3 direction, vec3 shares) {
  facesSeen = uvec3(0u, 2u, 4u) + uvec3(greaterThanEqual(direction, vec3(0.0)));
  shareOfFaces = shares;
}

vec4 voxelIn(uint brick, ivec3 voxel) {
  vec4 value = vec4(0.0);
  if (shareOfFaces.x > 0.0) value += shareOfFaces.x * texelFetch(brickPool, texelOf(brickOfFace(brick, facesSeen.x)) + voxel, 0);
  if (shareOfFaces.y > 0.0) value += shareOfFaces.y * texelFetch(brickPool, texelOf(brickOfFace(brick, facesSeen.y)) + voxel, 0);
  if (shareOfFaces.z > 0.0) value += shareOfFaces.z * texelFetch(brickPool, texelOf(brickOfFace(brick, facesSeen.z)) + voxel, 0);
  return value;
}
#else
vec4 voxelIn(uint brick, ivec3 voxel) { return texelFetch(brickPool, texelOf(brick) + voxel, 0); }
#endif

// Voxels are filtered here and not by a sampler, whose coordinates are rounded by where in which pool the brick lies: a frame would differ
// from the same frame alone. Cones as published use the sampler in published bricks.
#if LOOK_UP == LOOK_UP_OWN
// No loops but the published reading of six faces: of all turns of all loops of a shader some drivers allow 65535, which many cones come to.
// Those of a level around a point, `from` voxels from the middle of its voxel 0. Outside of the grid there is nothing.
struct Around {
  uint corners;  // kNone: there is nothing
  ivec3 own;     // the lowest voxel, in its brick
  uint crossed;  // axes along which the higher voxels are in the next brick
  vec3 part;     // voxels from there
};

Around voxelsAround(vec3 from, int depth) {
  vec3 at = clamp(floor(from), vec3(0.0), vec3(float((2 << depth) - 1)));
  ivec3 low = ivec3(at), own = low & 1;
  return Around(cornersOf(mortonOf(low >> 1), depth), own, uint(own.x | own.y << 1 | own.z << 2), clamp(from - at, vec3(-1.0), vec3(1.0)));
}

// The share of one of the eight: of bit 0, 1, 2 whether it is the higher one along x, y, z.
vec4 shareOfVoxel(Around around, uint which) {
  bvec3 higher = bvec3((which & 1u) != 0u, (which & 2u) != 0u, (which & 4u) != 0u);
  vec3 weights = mix(1.0 - abs(around.part), max(around.part, vec3(0.0)), higher);
  float weight = weights.x * weights.y * weights.z;
  uint brick = octreeCorners[around.corners + (which & around.crossed)];
  return brick != kNone && weight > 0.0 ? weight * voxelIn(brick, around.own ^ ivec3(higher)) : vec4(0.0);
}

vec4 amongVoxels(vec3 from, int depth) {
  Around around = voxelsAround(from, depth);
  if (around.corners == kNone) return vec4(0.0);
#if FACES == FACES_SIX
  // As published: eight voxels of three faces each are much to write out.
  vec4 value = vec4(0.0);
  for (uint which = 0u; which < 8u; ++which) value += shareOfVoxel(around, which);
  return value;
#else
  return shareOfVoxel(around, 0u) + shareOfVoxel(around, 1u) + shareOfVoxel(around, 2u) + shareOfVoxel(around, 3u) +
         shareOfVoxel(around, 4u) + shareOfVoxel(around, 5u) + shareOfVoxel(around, 6u) + shareOfVoxel(around, 7u);
#endif
}

// Of those whose place along an axis is a whole number: the four across it.
vec4 acrossAxis(vec3 from, int depth, int axis) {
  Around around = voxelsAround(from, depth);
  if (around.corners == kNone) return vec4(0.0);
  uint side = 1u << (axis + 1) % 3, up = 1u << (axis + 2) % 3;
  return shareOfVoxel(around, 0u) + shareOfVoxel(around, side) + shareOfVoxel(around, up) + shareOfVoxel(around, side | up);
}
#else
// In a brick, `at` voxels from its first one along each axis.
vec4 alongX(uint brick, ivec3 first, float part) { return mix(voxelIn(brick, first), voxelIn(brick, first + ivec3(1, 0, 0)), part); }
vec4 inBrick(uint brick, vec3 at) {
  ivec3 low = min(ivec3(at), ivec3(1));
  vec3 part = at - vec3(low);
  return mix(mix(alongX(brick, low, part.x), alongX(brick, low + ivec3(0, 1, 0), part.x), part.y),
             mix(alongX(brick, low + ivec3(0, 0, 1), part.x), alongX(brick, low + ivec3(0, 1, 1), part.x), part.y), part.z);
}
// The same by the hardware's filter (Listing 4.25).
vec4 sampledInBrick(uint brick, vec3 at) { return textureLod(brickPool, (vec3(texelOf(brick)) + 0.5 + at) / vec3(textureSize(brickPool, 0)), 0.0); }
#endif

// Values of a level, `from` voxels from the middle of its voxel 0. False: the tree has no node of that level there. Below its voxel 0 lies one
// with nothing in it. `sampled`: published bricks by the hardware's filter.
bool readVoxels(vec3 from, int level, bool sampled, out vec4 value) {
  int depth = octreeDepth - level;
#if LOOK_UP == LOOK_UP_OWN
  value = amongVoxels(from, depth);
  return value.a > 0.0;
#else
  vec3 inside = clamp(from, vec3(0.0), vec3(float(2 << depth)));
  ivec3 place = min(ivec3(inside) >> 1, ivec3((1 << depth) - 1));
  uint brick = brickOfNode(place, depth);
  vec3 border = clamp(1.0 + from, vec3(0.0), vec3(1.0));
  vec3 at = inside - vec3(2 * place);
  value = vec4(0.0);
  if (brick != kNone) value = border.x * border.y * border.z * (sampled ? sampledInBrick(brick, at) : inBrick(brick, at));
  return brick != kNone;
#endif
}

// The same around a point, finest voxels from storeLow.
bool readLevel(vec3 at, int level, bool sampled, out vec4 value) {
  return readVoxels(at * exp2(float(-level)) - firstVoxel * (firstVoxelGrows != 0.0 ? 1.0 : exp2(float(-level))), level, sampled, value);
}

#if FACES == FACES_SIX
vec4 interpolated(vec3 posWorld, vec3 direction, float level) {
  lookAtFaces(direction, faceWeights(direction));
  vec3 at = (posWorld - storeLow) / storeVoxel;
  vec4 finer, coarser = vec4(0.0);
  readLevel(at, int(level), false, finer);
  if (fract(level) > 0.0) readLevel(at, int(level) + 1, false, coarser);
  return mix(finer, coarser, fract(level));
}

// The face across an axis by the layer of voxels around a point of a level, in its voxels.
vec4 layerAcross(vec3 at, vec3 direction, int level, int axis) {
  vec3 share = vec3(0.0), from = at - 0.5;
  share[axis] = 1.0;
  from[axis] = floor(at[axis]);
  lookAtFaces(direction, share);
  return acrossAxis(from, octreeDepth - level, axis);
}

vec4 layers(vec3 posWorld, vec3 direction, float level, float stride) {
  float voxel = storeVoxel * exp2(level);
  vec3 at = (posWorld - storeLow) / voxel;
  vec4 x = layerAcross(at, direction, int(level), 0), y = layerAcross(at, direction, int(level), 1), z = layerAcross(at, direction, int(level), 2);
  return throughFaces(x, y, z, direction, at, (coneApex - storeLow) / voxel, level == 0.0, stride / voxel);
}

#include "../cones/read_faces.glsl"
#else
float longestStep(float size) { return kNoLimit; }

bool readsLayers() { return false; }

StoreSample readStore(vec3 at, vec3 direction, float size, float stride) {
  float blend, level = levelOf(max(size / storeVoxel, 1.0), storeCoarsest, blend);
  vec3 voxel = (at - storeLow) / storeVoxel;
  vec4 finer, coarser = vec4(0.0);
  readLevel(voxel, int(level), false, finer);
  if (blend > 0.0) readLevel(voxel, int(level) + 1, false, coarser);
  StoreSample result = StoreSample(mix(finer, coarser, blend), 0.0);
  if (result.value.a > 0.0) result.opacity = opacityOfStep(result.value.a, stride, level, blend);
  return result;
}
#endif

// Listing 4.25 counts levels from the root, so that their fraction is the share of the finer one, and gives it to the coarser; where the
// finer one ends there is nothing.
vec4 readStoreAsPublished(vec3 at, vec3 direction, float size) {
  float coarseness = clamp(log2(size / storeVoxel), 0.0, storeCoarsest), counted = storeCoarsest + 1.0 - coarseness;
#if FACES == FACES_SIX
  lookAtFaces(direction, faceWeights(direction));
#endif
  vec3 voxel = (at - storeLow) / storeVoxel;
  vec4 finer, coarser = vec4(0.0);
  if (!readLevel(voxel, int(floor(coarseness)), true, finer)) return vec4(0.0);
  if (fract(counted) > 0.0) readLevel(voxel, int(floor(coarseness)) + 1, true, coarser);
  return mix(finer, coarser, fract(counted));
}
