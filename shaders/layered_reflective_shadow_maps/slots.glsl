// The layer of a texel of a reflective shadow map: thesis 004, Sec. 3.3. A slot is a view, one of its depth intervals and a class of
// normals. Slots with at least one texel become layers.
#include "common/lights.glsl"

layout(std430, binding = 6) readonly buffer Views { mat4 views[]; };
layout(binding = 0) uniform sampler2DArray rsmPosition;
layout(binding = 1) uniform sampler2DArray rsmNormal;
layout(binding = 2) uniform sampler2DArray rsmFlux;

layout(std140, binding = 0) uniform Partition {
  int depthLayers;
  int normalLayers;  // 1, or 6: the sides of a cube
  float unit;        // radiance of the value 1, W/(sr m^2)
  int viewCount;     // of all lights
  float most;        // largest value of the radiance format
};

struct MapTexel {
  bool covered;  // by a surface
  vec3 posWorld;
  vec3 normal;
  float area;    // m^2
  int light;
};

MapTexel texelOf(ivec3 texel) {
  vec4 position = texelFetch(rsmPosition, texel, 0), normalArea = texelFetch(rsmNormal, texel, 0);
  int light = int(texelFetch(rsmFlux, texel, 0).w);
  return MapTexel(position.w > 0.0 && normalArea.w > 0.0, position.xyz, normalArea.xyz, normalArea.w, light);
}

// Depth along the view, m: for a directional light from the plane through the origin, otherwise from the light.
float depthOf(LightSample light, int view, vec3 posWorld) {
  return light.kind == kLightDirectional ? dot(posWorld, light.direction) : (views[view] * vec4(posWorld, 1.0)).w;
}

// A word that orders like the float.
uint inOrder(float value) {
  uint bits = floatBitsToUint(value);
  return (bits & 0x80000000u) != 0u ? ~bits : bits | 0x80000000u;
}
float fromOrder(uint word) { return uintBitsToFloat((word & 0x80000000u) != 0u ? word & 0x7fffffffu : ~word); }

// The number of a texel that belongs to no slot.
const uint kNoSlot = 0xffffffffu;
