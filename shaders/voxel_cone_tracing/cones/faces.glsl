// Voxels with six faces, each in a volume of its own, of any store. A cone sees the three faces of a voxel that face against its direction.
#include "through_faces.glsl"

// Named by the outward normals of the faces.
layout(binding = 12) uniform sampler3D positiveX;
layout(binding = 13) uniform sampler3D negativeX;
layout(binding = 6) uniform sampler3D positiveY;
layout(binding = 7) uniform sampler3D negativeY;
layout(binding = 14) uniform sampler3D positiveZ;
layout(binding = 15) uniform sampler3D negativeZ;

vec4 seenAlongX(vec3 direction, vec3 texcoord, float level) {
  return direction.x < 0.0 ? textureLod(positiveX, texcoord, level) : textureLod(negativeX, texcoord, level);
}
vec4 seenAlongY(vec3 direction, vec3 texcoord, float level) {
  return direction.y < 0.0 ? textureLod(positiveY, texcoord, level) : textureLod(negativeY, texcoord, level);
}
vec4 seenAlongZ(vec3 direction, vec3 texcoord, float level) {
  return direction.z < 0.0 ? textureLod(positiveZ, texcoord, level) : textureLod(negativeZ, texcoord, level);
}
