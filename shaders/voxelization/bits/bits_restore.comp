#version 450
// Resets the columns that had moving geometry in the last frame to static geometry. Their mark in `touched` changes from 1 to 2; all other
// marks become 0.
layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0, r32ui) uniform readonly uimage3D still;
layout(binding = 1, r32ui) uniform writeonly uimage3D words;
layout(binding = 2, r32ui) uniform uimage2D touched;

void main() {
  ivec2 column = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(column, imageSize(touched)))) return;
  bool moved = (imageLoad(touched, column).r & 1u) != 0u;
  imageStore(touched, column, uvec4(moved ? 2u : 0u));
  if (!moved) return;
  for (int z = 0; z < imageSize(words).z; ++z) imageStore(words, ivec3(column, z), imageLoad(still, ivec3(column, z)));
}
