// The six faces of a coarse voxel from the next finer level.
#include "common/cones.glsl"
#include "../children.glsl"

layout(std140, binding = 0) uniform Parameters {
  ivec3 coarse;      // voxels of the level that is written
  int levelOfFaces;  // mip of the textures that are read
  ivec3 fine;        // voxels of the level that is read
  int perBrick;      // of occupied bricks: 8 voxels of the level in a brick, or 1
};
// By the outward normals of the faces; all six the same texture where the finer level has no faces.
layout(binding = 0) uniform sampler3D positiveX;
layout(binding = 1) uniform sampler3D negativeX;
layout(binding = 2) uniform sampler3D positiveY;
layout(binding = 3) uniform sampler3D negativeY;
layout(binding = 4) uniform sampler3D positiveZ;
layout(binding = 5) uniform sampler3D negativeZ;
#include "../face_images.glsl"

// A child as seen by who looks towards lower coordinates, at its higher face, and by who looks the other way.
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
