#version 450
// Converts the parts of faces to occluded shares, and to how far their surfaces were moved.
#include "parts.glsl"
#include "bricks.glsl"

layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(binding = 0, r32ui) uniform readonly uimage3D partsX;
layout(binding = 1, r32ui) uniform readonly uimage3D partsY;
layout(binding = 2, r32ui) uniform readonly uimage3D partsZ;
layout(binding = 3, rgba8) uniform writeonly image3D occluded;
layout(binding = 4, rgba8) uniform writeonly image3D moved;

// The largest motion down and up, in steps rounded up.
float movedByte(uint bits) {
  int down = findMSB(bits >> kMovedDown & kMovedMask) + 1, up = findMSB(bits >> kMovedUp & kMovedMask) + 1;
  return float(down | up << 4) / 255.0;
}

void main() {
  ivec3 face = listedCell();
  if (any(greaterThanEqual(face, imageSize(occluded)))) return;
  uint x = imageLoad(partsX, face).r, y = imageLoad(partsY, face).r, z = imageLoad(partsZ, face).r;
  vec3 parts = vec3(bitCount(x & kPartsMask), bitCount(y & kPartsMask), bitCount(z & kPartsMask));
  imageStore(occluded, face, vec4(parts / 16.0, 0.0));
  imageStore(moved, face, vec4(movedByte(x), movedByte(y), movedByte(z), 0.0));
}
