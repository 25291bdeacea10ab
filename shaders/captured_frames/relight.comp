#version 450
// Captured lights times the change of irradiance that virtual content causes where they lie.
layout(local_size_x = 64) in;
#include "common/list.glsl"
#include "common/rsm.glsl"
#include "change.glsl"

layout(std140, binding = 0) uniform Parameters {
  int lights;
  float tanHalfFov;  // of the view
  vec2 shift;        // of the view's rays, pixels
  vec3 eye;          // posWorld
  vec3 right, down, forward;
};
layout(binding = 0) uniform sampler2D gPosition;  // of real surfaces
layout(binding = 1) uniform sampler2D beforeRadiance;
layout(binding = 2) uniform sampler2D afterRadiance;
layout(binding = 3) uniform sampler2D addedRadiance;  // by the light that virtual content sends
layout(std430, binding = 0) readonly buffer Captured { SurfaceLight captured[]; };
layout(std430, binding = 1) writeonly buffer Relit { SurfaceLight relit[]; };

// The change at a light's place; none where the view shows another surface, or nothing, in its direction.
vec3 changeAt(vec3 posWorld) {
  const float kApart = 0.05;  // of the depth
  vec3 path = posWorld - eye;
  float depth = dot(path, forward);
  if (depth <= 0.0) return vec3(1.0);
  ivec2 size = textureSize(gPosition, 0);
  vec2 slope = vec2(dot(path, right), dot(path, down)) / depth;
  ivec2 pixel = ivec2(floor(0.5 * (slope / tanHalfFov * float(size.y) + vec2(size)) - shift));
  if (any(lessThan(pixel, ivec2(0))) || any(greaterThanEqual(pixel, size))) return vec3(1.0);
  vec4 seen = texelFetch(gPosition, pixel, 0);
  if (seen.w == 0.0 || distance(seen.xyz, posWorld) > kApart * depth) return vec3(1.0);
  return changeOf(texelFetch(beforeRadiance, pixel, 0).rgb, texelFetch(afterRadiance, pixel, 0).rgb + texelFetch(addedRadiance, pixel, 0).rgb);
}

void main() {
  uint index = listIndex();
  if (index >= uint(lights)) return;
  SurfaceLight light = captured[index];
  light.flux.rgb *= changeAt(light.positionArea.xyz);
  relit[index] = light;
}
