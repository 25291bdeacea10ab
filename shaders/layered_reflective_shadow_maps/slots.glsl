// Which layer a texel of a map belongs to: thesis 004, Sec. 3.3. A slot is a view, an interval of its depths and a class of normals; those that
// have a texel become layers.
#include "common/lights.glsl"

layout(std430, binding = 6) readonly buffer Views { mat4 views[]; };
layout(binding = 0) uniform sampler2DArray rsmPosition;
layout(binding = 1) uniform sampler2DArray rsmNormal;
layout(binding = 2) uniform sampler2DArray rsmFlux;

layout(std140, binding = 0) uniform Partition {
  int depthLayers;
  int normalLayers;  // 1, or 6: the sides of a cube
  float unit;        // W/(sr m^2) that the value 1 stands for
  int viewCount;     // of all lights
  float most;        // that the format of radiance holds
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

// Along the view, m: from a directional light's origin plane, else from the light.
float depthOf(LightSample light, int view, vec3 posWorld) {
  return light.kind == kLightDirectional ? dot(posWorld, light.direction) : (views[view] * vec4(posWorld, 1.0)).w;
}

// Floats in the order of words.
uint inOrder(float value) {
  uint bits = floatBitsToUint(value);
  return (bits & 0x80000000u) != 0u ? ~bits : bits | 0x80000000u;
}
float fromOrder(uint word) { return uintBitsToFloat((word & 0x80000000u) != 0u ? word & 0x7fffffffu : ~word); }

// The number of a texel that belongs to no slot.
const uint kNoSlot = 0xffffffffu;
