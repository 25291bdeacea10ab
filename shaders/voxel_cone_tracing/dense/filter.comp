#version 450
// Pre-filtering of one level from the next finer one (Crassin et al. 2011, Sec. 5; thesis 004 Sec. 4.2.1 Mipmapping).
//
// Along each of the three axes the children are composited front to back in each column, both ways, and the columns are averaged: what
// looking through the coarse voxel along that axis would see. Its opacity is the largest of the three, that of the axis which a surface
// faces. So
// - a uniform medium of opacity a per voxel gets 1 - (1-a)^2: its transmittance does not depend on the level that a cone reads;
// - a sheet one voxel thick of opacity a keeps a at every level, while the plain mean of the thesis halves it at every level and lets
//   light escape. So does, more slowly, any mean over the axes: along the sheet only half of the columns meet it.
// Radiance over opacity is a mean of what is blended, over the axes weighted by the square of their opacities. `average` is the
// published mean of the eight children, over all that a coarse voxel shares in.
//
// OCCUPIED: only the coarse voxels in occupied bricks of 4 x 4 x 4 finest voxels are made; the others are 0 already. A brick has 2 x 2 x 2
// voxels of level 1 and one of level 2.
#pragma lumivox axis OCCUPIED 0 1

#if OCCUPIED
#include "common/voxel.glsl"
layout(local_size_x = 64) in;
#include "common/list.glsl"
layout(std430, binding = 0) readonly buffer BrickList { uint brickList[]; };
layout(std430, binding = 1) readonly buffer BrickCount { uint listed; };
#else
layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;
#endif

#include "common/cones.glsl"
#include "../children.glsl"

const int kFacing = 0, kAverage = 1;
layout(constant_id = 0) const int rule = kFacing;

layout(std140, binding = 0) uniform Parameters {
  ivec3 coarse;   // voxels of the level that is written
  int fineLevel;
  ivec3 fine;     // voxels of the level that is read
};
layout(binding = 0) uniform sampler3D radianceGrid;
layout(binding = 0) uniform writeonly image3D radianceImage;  // of whatever float format the grid has

// Mean over the columns along one axis, and over both ways along it.
vec4 lookThrough(ivec3 cell, int axis, ivec3 first, ivec3 last, vec3 ratio) {
  int side = (axis + 1) % 3, up = (axis + 2) % 3;
  vec4 sum = vec4(0.0);
  float weight = 0.0;
  for (int v = first[up]; v <= last[up]; ++v)
    for (int u = first[side]; u <= last[side]; ++u) {
      float part = share(cell[up], v, ratio[up]) * share(cell[side], u, ratio[side]);
      vec4 ahead = vec4(0.0), back = vec4(0.0);
      for (int w = first[axis]; w <= last[axis]; ++w) {
        ivec3 child;
        child[axis] = w;
        child[side] = u;
        child[up] = v;
        vec4 value = slab(texelFetch(radianceGrid, child, fineLevel), share(cell[axis], w, ratio[axis]));
        ahead = over(ahead, value);
        back = over(value, back);
      }
      sum += part * (ahead + back);
      weight += 2.0 * part;
    }
  return sum / weight;
}

void filterCell(ivec3 cell) {
  if (rule == kFacing && fine == 2 * coarse) {
    vec4 child[8];
    for (int i = 0; i < 8; ++i) child[i] = texelFetch(radianceGrid, 2 * cell + ivec3(i & 1, i >> 1 & 1, i >> 2), fineLevel);
    imageStore(radianceImage, cell, seenThrough(child));
    return;
  }
  vec3 ratio = vec3(fine) / vec3(coarse);
  ivec3 first = ivec3(floor(vec3(cell) * ratio)), last = min(ivec3(ceil(vec3(cell + 1) * ratio)) - 1, fine - 1);

  if (rule == kFacing) {
    imageStore(radianceImage, cell,
               facing(lookThrough(cell, 0, first, last, ratio), lookThrough(cell, 1, first, last, ratio),
                      lookThrough(cell, 2, first, last, ratio)));
    return;
  }
  vec4 sum = vec4(0.0);
  float weight = 0.0;
  for (int z = first.z; z <= last.z; ++z)
    for (int y = first.y; y <= last.y; ++y)
      for (int x = first.x; x <= last.x; ++x) {
        float part = share(cell.x, x, ratio.x) * share(cell.y, y, ratio.y) * share(cell.z, z, ratio.z);
        sum += part * texelFetch(radianceGrid, ivec3(x, y, z), fineLevel);
        weight += part;
      }
  imageStore(radianceImage, cell, weight > 0.0 ? sum / weight : vec4(0.0));
}

void main() {
#if OCCUPIED
  uint item = listIndex();
  uint perBrick = fineLevel == 0 ? 8u : 1u;
  if (item / perBrick >= listed) return;
  ivec3 brick = unpackVoxel(brickList[item / perBrick]);
  ivec3 cell = fineLevel == 0 ? 2 * brick + ivec3(item & 1u, item >> 1 & 1u, item >> 2 & 1u) : brick;
#else
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(cell, coarse))) return;
#endif
  filterCell(cell);
}
