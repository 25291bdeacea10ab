// Sec. 4.2.1, Fig. 64: the two children of a column along an axis are composited front to back as seen from either side, and the four
// columns are averaged. At odd sizes the last children are missed. Both faces of an axis have the same opacity and different radiance.
#include "common/cones.glsl"

layout(std140, binding = 0) uniform Parameters {
  ivec3 coarse;  // voxels of the level that is written
  int fineLevel;
};
// Named by the outward normals of the faces.
layout(binding = 0) uniform sampler3D positiveX;
layout(binding = 1) uniform sampler3D negativeX;
layout(binding = 2) uniform sampler3D positiveY;
layout(binding = 3) uniform sampler3D negativeY;
layout(binding = 4) uniform sampler3D positiveZ;
layout(binding = 5) uniform sampler3D negativeZ;
layout(binding = 0) uniform writeonly image3D positiveXImage;
layout(binding = 1) uniform writeonly image3D negativeXImage;
layout(binding = 2) uniform writeonly image3D positiveYImage;
layout(binding = 3) uniform writeonly image3D negativeYImage;
layout(binding = 4) uniform writeonly image3D positiveZImage;
layout(binding = 5) uniform writeonly image3D negativeZImage;

// The face of a child whose outward normal points to lower coordinates; higherFace: to higher coordinates.
vec4 lowerFace(int axis, ivec3 child) {
  return axis == 0 ? texelFetch(negativeX, child, fineLevel)
       : axis == 1 ? texelFetch(negativeY, child, fineLevel)
                   : texelFetch(negativeZ, child, fineLevel);
}
vec4 higherFace(int axis, ivec3 child) {
  return axis == 0 ? texelFetch(positiveX, child, fineLevel)
       : axis == 1 ? texelFetch(positiveY, child, fineLevel)
                   : texelFetch(positiveZ, child, fineLevel);
}

void seenAlong(int axis, ivec3 first, out vec4 lower, out vec4 higher) {
  lower = higher = vec4(0.0);
  for (int column = 0; column < 4; ++column) {
    ivec3 near = first;
    near[(axis + 1) % 3] += column & 1;
    near[(axis + 2) % 3] += column >> 1;
    ivec3 far = near;
    far[axis] += 1;
    lower += over(lowerFace(axis, near), lowerFace(axis, far));
    higher += over(higherFace(axis, far), higherFace(axis, near));
  }
  lower /= 4.0;
  higher /= 4.0;
}

void mipmapCell(ivec3 cell) {
  vec4 lower, higher;
  seenAlong(0, 2 * cell, lower, higher);
  imageStore(negativeXImage, cell, lower);
  imageStore(positiveXImage, cell, higher);
  seenAlong(1, 2 * cell, lower, higher);
  imageStore(negativeYImage, cell, lower);
  imageStore(positiveYImage, cell, higher);
  seenAlong(2, 2 * cell, lower, higher);
  imageStore(negativeZImage, cell, lower);
  imageStore(positiveZImage, cell, higher);
}
