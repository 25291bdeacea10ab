#version 450
// Copies the bits of static geometry, to which moving geometry is added.
layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0, r32ui) uniform readonly uimage3D source;
layout(binding = 1, r32ui) uniform writeonly uimage3D target;

void main() {
  ivec3 place = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(place, imageSize(target)))) return;
  imageStore(target, place, imageLoad(source, place));
}
