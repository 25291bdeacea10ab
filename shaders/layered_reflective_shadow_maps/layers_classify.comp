#version 450
// Finds the slot of each texel, and marks the slots that have texels.
layout(local_size_x = 8, local_size_y = 8) in;
#include "slots.glsl"

layout(std430, binding = 2) readonly buffer Bounds { float bounds[]; };
layout(std430, binding = 3) buffer Used { uint used[]; };
layout(binding = 0, r32ui) uniform writeonly uimage2DArray slotImage;

void main() {
  ivec3 texel = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(texel, textureSize(rsmPosition, 0)))) return;
  MapTexel seen = texelOf(texel);
  uint slot = kNoSlot;
  if (seen.covered) {
    float depth = depthOf(lights[seen.light], texel.z, seen.posWorld);
    int interval = 0;
    for (int i = 1; i < depthLayers; ++i) interval += depth >= bounds[texel.z * (depthLayers + 1) + i] ? 1 : 0;
    int facing = normalLayers > 1 ? cubeFace(seen.normal) : 0;
    slot = uint((texel.z * depthLayers + interval) * normalLayers + facing);
    atomicOr(used[slot], 1u);
  }
  imageStore(slotImage, texel, uvec4(slot));
}
