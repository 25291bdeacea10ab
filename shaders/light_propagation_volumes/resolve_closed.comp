#version 450
// Parts of faces to shares.
layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(binding = 0, r32ui) uniform readonly uimage3D partsX;
layout(binding = 1, r32ui) uniform readonly uimage3D partsY;
layout(binding = 2, r32ui) uniform readonly uimage3D partsZ;
layout(binding = 3, rgba8) uniform writeonly image3D closed;

void main() {
  ivec3 face = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(face, imageSize(closed)))) return;
  vec3 parts = vec3(bitCount(imageLoad(partsX, face).r), bitCount(imageLoad(partsY, face).r), bitCount(imageLoad(partsZ, face).r));
  imageStore(closed, face, vec4(parts / 16.0, 0.0));
}
