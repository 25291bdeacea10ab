// A sparse voxel octree: Crassin et al. 2011, Sec. 4 and 7. Space without nodes is empty, and no voxels are read there. Each node lists the
// bricks around it; the node is found by the number of tags before its own, in two reads at any depth.
//
// FACES six: each voxel has six faces, read by the rules of the six directional grids.
#pragma lumivox axis FACES one six
#pragma lumivox require FACES == one || STORE == octree
#include "octree.glsl"
#include "octree_corners.glsl"

layout(binding = 4) uniform sampler3D brickPool;

vec2 insideStore(vec3 origin, vec3 direction) { return insideVolume(storeLow, storeExtent, origin, direction); }

float finestVoxel(vec3 at) { return storeVoxel; }

#if FACES == FACES_SIX
#include "../cones/through_faces.glsl"
// The faces that the cone sees, across x, y and z, and their weights.
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

// Voxels are filtered here instead of by a sampler. A sampler rounds its coordinates depending on the brick's position in the pool, so that
// the same frame could differ between runs. There are no loops, except in the published reading of six faces: some drivers allow 65535
// iterations of all loops of a shader together, which many cones reach.
//
// The eight voxels of a level around a point, `from` voxels from the centre of voxel 0. Outside the grid all is empty.
struct Around {
  uint corners;  // index into octreeCorners; kNone: empty
  ivec3 own;     // the lowest voxel, in its brick
  uint crossed;  // bits of the axes along which the higher voxels are in the next brick
  vec3 part;     // offset of the point from the lowest voxel, in voxels
};

Around voxelsAround(vec3 from, int depth) {
  vec3 at = clamp(floor(from), vec3(0.0), vec3(float((2 << depth) - 1)));
  ivec3 low = ivec3(at), own = low & 1;
  return Around(cornersOf(mortonOf(low >> 1), depth), own, uint(own.x | own.y << 1 | own.z << 2), clamp(from - at, vec3(-1.0), vec3(1.0)));
}

// Weighted value of one of the eight voxels: bits 0, 1, 2 of `which` are set for the higher voxel along x, y, z.
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
  // A loop, because eight voxels of three faces each are too much unrolled code.
  vec4 value = vec4(0.0);
  for (uint which = 0u; which < 8u; ++which) value += shareOfVoxel(around, which);
  return value;
#else
  return shareOfVoxel(around, 0u) + shareOfVoxel(around, 1u) + shareOfVoxel(around, 2u) + shareOfVoxel(around, 3u) +
         shareOfVoxel(around, 4u) + shareOfVoxel(around, 5u) + shareOfVoxel(around, 6u) + shareOfVoxel(around, 7u);
#endif
}

// Bilinear value of the four voxels of a layer across an axis; `from` is an integer along this axis.
vec4 acrossAxis(vec3 from, int depth, int axis) {
  Around around = voxelsAround(from, depth);
  if (around.corners == kNone) return vec4(0.0);
  uint side = 1u << (axis + 1) % 3, up = 1u << (axis + 2) % 3;
  return shareOfVoxel(around, 0u) + shareOfVoxel(around, side) + shareOfVoxel(around, up) + shareOfVoxel(around, side | up);
}

// Trilinear value of a level at a point, in finest voxels from storeLow.
vec4 readLevel(vec3 at, int level) { return amongVoxels(at * exp2(float(-level)) - 0.5, octreeDepth - level); }

#if FACES == FACES_SIX
vec4 interpolated(vec3 posWorld, vec3 direction, float level) {
  lookAtFaces(direction, faceWeights(direction));
  vec3 at = (posWorld - storeLow) / storeVoxel;
  vec4 finer = readLevel(at, int(level)), coarser = vec4(0.0);
  if (fract(level) > 0.0) coarser = readLevel(at, int(level) + 1);
  return mix(finer, coarser, fract(level));
}

// The face across an axis, read from the layer of voxels that contains a point of a level, in voxels of the level.
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
  vec4 finer = readLevel(voxel, int(level)), coarser = vec4(0.0);
  if (blend > 0.0) coarser = readLevel(voxel, int(level) + 1);
  StoreSample result = StoreSample(mix(finer, coarser, blend), 0.0);
  if (result.value.a > 0.0) result.opacity = opacityOfStep(result.value.a, stride, level, blend);
  return result;
}
#endif
