// Radiance of the surface at a point that a ray met, as the reflective shadow maps know it: thesis 004, Sec. 3.2.3 and Listing 4.49.
#include "common/lights.glsl"

layout(std430, binding = 6) readonly buffer Views { mat4 views[]; };
layout(binding = 3) uniform sampler2DArray rsmPosition;
layout(binding = 4) uniform sampler2DArray rsmNormal;
layout(binding = 5) uniform sampler2DArray rsmFlux;

layout(constant_id = 0) const int taps = 1;       // 4: the four texels around the point, bilinearly
layout(constant_id = 1) const int frontTest = 1;  // whether surfaces that look away from the receiver bring nothing
// 1: the tests of Listing 4.49 as printed. The tolerance enlarges the texel's side alone, whose slant is that to the direction of a sun or a
// spot and counts only with frontTest; the receiver is where it is, an offset off where its rays begin.
layout(constant_id = 6) const int printedTests = 0;

layout(std140, binding = 2) uniform BackProjection {
  float voxelDiagonal;  // m
  float tolerance;      // factor on the distance of a surface from the point; below 0: no test
  float cap;            // most of that distance, m; below 0: none
  float leastCosine;    // between a surface and the light
  int firstLight;       // light samples that this dispatch adds
  int lightsAtOnce;
};

// What a texel shines to a receiver, W/(sr m^2): nothing when its surface is not at the point, or looks the other way.
vec3 radianceOfTexel(LightSample light, ivec3 texel, float depth, vec3 point, vec3 toReceiver) {
  vec4 position = texelFetch(rsmPosition, texel, 0);
  vec4 normalArea = texelFetch(rsmNormal, texel, 0);
  if (!(position.w > 0.0 && normalArea.w > 0.0)) return vec3(0.0);
  if (frontTest != 0 && dot(normalArea.xyz, toReceiver) < 0.0) return vec3(0.0);
  if (tolerance >= 0.0) {
    bool parallel = light.kind == kLightDirectional;
    vec3 toLight = parallel ? -light.direction : normalize(light.position - position.xyz);
    float width = light.texelWidth * (parallel ? 1.0 : depth);
    if (printedTests != 0 && light.kind == kLightSpot) toLight = -light.direction;
    float slant = printedTests != 0 && frontTest == 0 ? 1.0 : max(dot(normalArea.xyz, toLight), leastCosine);
    float side = width / slant;
    float allowed = max(voxelDiagonal, printedTests != 0 ? tolerance * side : side);
    if (cap >= 0.0) allowed = min(allowed, cap);
    if (distance(point, position.xyz) > (printedTests != 0 ? 1.0 : tolerance) * allowed) return vec3(0.0);
  }
  // Exitance, the flux of the texel over its area, goes to all sides alike.
  return texelFetch(rsmFlux, texel, 0).rgb / (kPi * normalArea.w);
}

// Of one light, of any kind.
vec3 backProjected(LightSample light, vec3 point, vec3 toReceiver) {
  if (light.firstView < 0) return vec3(0.0);
  int layer = light.firstView;
  if (light.viewCount > 1) layer += cubeFace(point - light.position);
  vec4 clip = views[layer] * vec4(point, 1.0);
  if (!(clip.w > 0.0)) return vec3(0.0);  // behind the light
  vec2 projected = clip.xy / clip.w;
  ivec2 size = textureSize(rsmPosition, 0).xy;
  vec2 place = vec2(0.5 + 0.5 * projected.x, 0.5 - 0.5 * projected.y) * vec2(size);
  if (any(lessThan(place, vec2(0.0))) || any(greaterThan(place, vec2(size)))) return vec3(0.0);
  // The last texel of a face holds its far edge too.
  if (taps == 1) return radianceOfTexel(light, ivec3(min(ivec2(place), size - 1), layer), clip.w, point, toReceiver);
  vec2 low = floor(place - 0.5), share = place - 0.5 - low;
  vec3 sum = vec3(0.0);
  for (int i = 0; i < 4; ++i) {
    ivec2 step = ivec2(i & 1, i >> 1);
    vec2 weight = mix(1.0 - share, share, vec2(step));
    ivec2 texel = clamp(ivec2(low) + step, ivec2(0), size - 1);
    sum += weight.x * weight.y * radianceOfTexel(light, ivec3(texel, layer), clip.w, point, toReceiver);
  }
  return sum;
}

vec3 radianceAt(vec3 point, vec3 toReceiver) {
  vec3 sum = vec3(0.0);
  for (int i = firstLight; i < firstLight + lightsAtOnce; ++i) sum += backProjected(lights[i], point, toReceiver);
  return sum;
}
