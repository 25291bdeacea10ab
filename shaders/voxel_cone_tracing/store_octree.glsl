// A sparse voxel octree: Crassin et al. 2011, Sec. 4 and 7; thesis 004, Sec. 4.2.2, Listing 4.25. A sample descends from the root to the
// coarser of its two levels and on to the finer one; where the tree ends there is nothing, and nothing is read.
#include "octree.glsl"

layout(std140, binding = 4) uniform OctreeStore {
  vec3 poolSize;        // texels
  float firstVertex;    // of vertex 0 of the bricks, voxels from storeLow
};
layout(binding = 4) uniform sampler3D brickPool;

vec2 insideStore(vec3 origin, vec3 direction) { return insideVolume(storeLow, storeExtent, origin, direction); }

float finestVoxel(vec3 at) { return storeVoxel; }

float sizeForStep(float size) { return size; }

// In the brick of a node; `at` counts voxels of the node's level from the first vertex of all.
vec4 inBrick(uint brick, vec3 at, vec3 place) {
  if (brick == kNone) return vec4(0.0);
  return textureLod(brickPool, (vec3(texelOf(brick)) + 0.5 + at - 2.0 * place) / poolSize, 0.0);
}

// Values of a level and of the next coarser one; `at` counts finest voxels from the first vertex. False: the tree has no node of the level.
bool readLevels(vec3 at, int level, out vec4 finer, out vec4 coarser) {
  finer = coarser = vec4(0.0);
  float nodeSize = exp2(float(level + 1));
  ivec3 last = ivec3((1 << octreeDepth - level) - 1), place = clamp(ivec3(at / nodeSize), ivec3(0), last);
  uint node = 0u, above = kNone;
  for (int below = octreeDepth - level - 1; below >= 0; --below) {
    uint tile = octreeNodes[node].children;
    above = node;
    if (tile == kNone) {
      // The level above may be the last that the tree has here.
      if (below == 0) coarser = inBrick(octreeNodes[node].brick, at / nodeSize, vec3(place >> 1));
      return false;
    }
    ivec3 side = place >> below & 1;
    node = tile + uint(side.x | side.y << 1 | side.z << 2);
  }
  finer = inBrick(octreeNodes[node].brick, 2.0 * at / nodeSize, vec3(place));
  if (above != kNone) coarser = inBrick(octreeNodes[above].brick, at / nodeSize, vec3(place >> 1));
  return octreeNodes[node].brick != kNone;
}

vec3 fromFirstVertex(vec3 at) { return clamp((at - storeLow) / storeVoxel - firstVertex, vec3(0.0), vec3(float(2 << octreeDepth))); }

StoreSample readStore(vec3 at, vec3 direction, float size, float stride) {
  float blend, level = levelOf(max(size / storeVoxel, 1.0), storeCoarsest, blend);
  vec4 finer, coarser;
  readLevels(fromFirstVertex(at), int(level), finer, coarser);
  StoreSample result = StoreSample(mix(finer, coarser, blend), 0.0);
  if (result.value.a > 0.0) result.opacity = opacityOfStep(result.value.a, stride, level, blend);
  return result;
}

// Listing 4.25 counts levels from the root, so that their fraction f is the share of the finer one, and gives it to the coarser; where the
// finer one ends there is nothing.
vec4 readStoreAsPublished(vec3 at, vec3 direction, float size) {
  float coarseness = clamp(log2(size / storeVoxel), 0.0, storeCoarsest), level = floor(coarseness);
  vec4 finer, coarser;
  bool isThere = readLevels(fromFirstVertex(at), int(level), finer, coarser);
  return isThere ? mix(finer, coarser, fract(storeCoarsest + 1.0 - coarseness)) : vec4(0.0);
}
