// The store that cones read, with values blended between levels: one grid (Listing 4.14), six directional grids (Listing 4.15) or an octree
// (Listing 4.25). C++ side: techniques/thesis_cone_tracing/gather.cpp.
#pragma lumivox axis STORE grid six octree
#include "common/cones.glsl"
#if STORE == STORE_OCTREE
#include "octree.glsl"
#endif

layout(std140, binding = 1) uniform Store {
  vec3 storeLow;        // m
  float storeVoxel;     // size of the finest voxels, m
  vec3 storeExtent;     // m
  float storeUnit;      // radiance of the value 1, W/(sr m^2)
  float storeCoarsest;  // coarsest level of an octree
};

// readStore(): rgb radiance / storeUnit, pre-multiplied by the opacity a, around a point, in voxels of `size` m.
#if STORE == STORE_GRID
layout(binding = 4) uniform sampler3D radianceGrid;

vec4 readStore(vec3 at, vec3 direction, float size) {
  return textureLod(radianceGrid, (at - storeLow) / storeExtent, log2(size / storeVoxel));
}

#elif STORE == STORE_SIX
// Named by the outward normals of the faces. A cone sees the three that face against its direction.
layout(binding = 6) uniform sampler3D positiveX;
layout(binding = 7) uniform sampler3D negativeX;
layout(binding = 8) uniform sampler3D positiveY;
layout(binding = 9) uniform sampler3D negativeY;
layout(binding = 10) uniform sampler3D positiveZ;
layout(binding = 11) uniform sampler3D negativeZ;

vec4 readStore(vec3 at, vec3 direction, float size) {
  vec3 texcoord = (at - storeLow) / storeExtent, along = abs(direction), weights = along / (along.x + along.y + along.z);
  float level = log2(size / storeVoxel);
  return weights.x * (direction.x < 0.0 ? textureLod(positiveX, texcoord, level) : textureLod(negativeX, texcoord, level)) +
         weights.y * (direction.y < 0.0 ? textureLod(positiveY, texcoord, level) : textureLod(negativeY, texcoord, level)) +
         weights.z * (direction.z < 0.0 ? textureLod(positiveZ, texcoord, level) : textureLod(negativeZ, texcoord, level));
}

#else
layout(binding = 4) uniform sampler3D brickPool;

// Value of a level at a point, in finest voxels from storeLow, by the hardware filter within a brick. False: the tree has no node of that
// level there. The voxel below voxel 0 of a level counts as empty.
bool readLevel(vec3 at, int level, out vec4 value) {
  int depth = octreeDepth - level;
  // The centre of voxel 0 has the same position at all levels.
  float firstVoxel = octreeAtCorners != 0 ? 0.5 : 0.0;
  vec3 from = at * exp2(float(-level)) - firstVoxel * exp2(float(-level));
  vec3 inside = clamp(from, vec3(0.0), vec3(float(2 << depth)));
  ivec3 place = min(ivec3(inside) >> 1, ivec3((1 << depth) - 1));
  uint brick = brickAt(place, depth);
  value = vec4(0.0);
  if (brick == kNone) return false;
  vec3 border = clamp(1.0 + from, vec3(0.0), vec3(1.0)), inBrick = inside - vec3(2 * place);
  value = border.x * border.y * border.z *
          textureLod(brickPool, (vec3(texelOf(brick)) + 0.5 + inBrick) / vec3(textureSize(brickPool, 0)), 0.0);
  return true;
}

// Listing 4.25 counts levels from the root, so that the fraction is the share of the finer level, but gives it to the coarser level. Where
// the finer level has no node, the value is 0.
vec4 readStore(vec3 at, vec3 direction, float size) {
  float coarseness = clamp(log2(size / storeVoxel), 0.0, storeCoarsest), counted = storeCoarsest + 1.0 - coarseness;
  vec3 voxel = (at - storeLow) / storeVoxel;
  vec4 finer, coarser = vec4(0.0);
  if (!readLevel(voxel, int(floor(coarseness)), finer)) return vec4(0.0);
  if (fract(counted) > 0.0) readLevel(voxel, int(floor(coarseness)) + 1, coarser);
  return mix(finer, coarser, fract(counted));
}
#endif
