#version 450
// Finds the nearest and the farthest depth of each view.
layout(local_size_x = 8, local_size_y = 8) in;
#include "slots.glsl"

layout(std430, binding = 0) buffer Ranges { uint ranges[]; };  // two of a view: its lowest, and the complement of its highest, in the order of words

void main() {
  ivec3 texel = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(texel, textureSize(rsmPosition, 0)))) return;
  MapTexel seen = texelOf(texel);
  if (!seen.covered) return;
  uint depth = inOrder(depthOf(lights[seen.light], texel.z, seen.posWorld));
  atomicMin(ranges[2 * texel.z], depth);
  atomicMin(ranges[2 * texel.z + 1], ~depth);
}
