#version 450
// Filters one level of the six directional grids from the next finer level (Crassin et al. 2011, Sec. 8.1; thesis 004, Sec. 3.1.3 and
// 4.2.1, Fig. 64): the children of a column are composited front to back as seen from the side of the face, and the columns are averaged.
//
// Along an axis, a uniform medium of opacity a per voxel gets 1 - (1-a)^2, and a sheet across the axis keeps its opacity at every level.
// Both faces of an axis have the same opacity and different radiance.
//
// OCCUPIED: only the coarse voxels in occupied bricks of 4 x 4 x 4 finest voxels, as in filter.comp.
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
#include "common/coarser_voxel.glsl"

layout(std140, binding = 0) uniform Parameters {
  ivec3 coarse;      // voxels of the level that is written
  int levelOfFaces;  // mip level of the textures that are read
  ivec3 fine;        // voxels of the level that is read
  int perBrick;      // OCCUPIED: number of voxels of the level in a brick, 8 or 1
};
// Named by the outward normals of the faces; all six are the same texture if the finer level has no faces.
layout(binding = 0) uniform sampler3D positiveX;
layout(binding = 1) uniform sampler3D negativeX;
layout(binding = 2) uniform sampler3D positiveY;
layout(binding = 3) uniform sampler3D negativeY;
layout(binding = 4) uniform sampler3D positiveZ;
layout(binding = 5) uniform sampler3D negativeZ;
#include "../face_images.glsl"

// The face of a child seen by a ray towards lower coordinates. lowerFace: by a ray towards higher coordinates.
vec4 higherFace(int axis, ivec3 child) {
  return axis == 0 ? texelFetch(positiveX, child, levelOfFaces)
       : axis == 1 ? texelFetch(positiveY, child, levelOfFaces)
                   : texelFetch(positiveZ, child, levelOfFaces);
}
vec4 lowerFace(int axis, ivec3 child) {
  return axis == 0 ? texelFetch(negativeX, child, levelOfFaces)
       : axis == 1 ? texelFetch(negativeY, child, levelOfFaces)
                   : texelFetch(negativeZ, child, levelOfFaces);
}

#include "../columns.glsl"

void filterCell(ivec3 cell) {
  vec3 ratio = vec3(fine) / vec3(coarse);
  ivec3 first = ivec3(floor(vec3(cell) * ratio)), last = min(ivec3(ceil(vec3(cell + 1) * ratio)) - 1, fine - 1);
  vec4 faces[6];
  for (int axis = 0; axis < 3; ++axis) lookThrough(cell, axis, first, last, ratio, faces[2 * axis], faces[2 * axis + 1]);
  storeFaces(cell, faces);
}

void main() {
#if OCCUPIED
  uint item = listIndex();
  if (item / uint(perBrick) >= listed) return;
  ivec3 brick = unpackVoxel(brickList[item / uint(perBrick)]);
  ivec3 cell = perBrick == 8 ? 2 * brick + ivec3(item & 1u, item >> 1 & 1u, item >> 2 & 1u) : brick;
#else
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(cell, coarse))) return;
#endif
  filterCell(cell);
}
