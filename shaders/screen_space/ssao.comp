#version 450
// Screen-space ambient occlusion (Mittring 2007): the share of points around a surface that lie in front of the visible surfaces.
#include "screen.glsl"

const int kSphere = 0, kHemisphere = 1;
layout(constant_id = 1) const int directions = kSphere;

layout(std140, binding = 0) uniform Occlusion {
  float range;  // largest distance of an occluder's plane in front of the surface point, m
};

// The i-th point relative to the centre of the sphere, uniform in volume. With kSphere, each stratum has a pair of opposite points, one of
// which a plane through the centre occludes; with an odd number of points, the last stratum has only the point above.
vec3 offsetOf(int i, int strata, vec3 normal, vec4 random) {
  bool sphere = directions == kSphere;
  int stratum = sphere ? i / 2 : i;
  float height = (float(stratum) + random.x) / float(strata);
  vec2 place = evenly(stratum, random.yz);
  float distance = radius * pow(place.y, 1.0 / 3.0);
  vec3 direction = around(normal, sphere ? height : sqrt(height), place.x);
  return distance * (sphere && (i & 1) == 1 ? -direction : direction);
}

float unoccluded(ivec2 pixel, vec3 posWorld) {
  vec3 normal = texelFetch(gNormal, pixel, 0).xyz;
  vec4 random = randomOf(pixel);
  int open = 0, strata = directions == kSphere ? (samples + 1) / 2 : samples;
  for (int i = 0; i < samples; ++i) {
    ivec2 other;
    vec3 offset = offsetOf(i, strata, normal, random);
    bool blocked = isBehindVisible(posWorld + offset, other);
    // Distance of the occluder's plane instead of depth: a slanted floor occludes points below it from far in front. If the occluder is
    // beyond the range, the surface itself occludes the points below it.
    if (blocked && dot(texelFetch(gPosition, other, 0).xyz - posWorld, texelFetch(gGeometricNormal, other, 0).xyz) > range)
      blocked = dot(offset, texelFetch(gGeometricNormal, pixel, 0).xyz) < 0.0;
    open += blocked ? 0 : 1;
  }
  return float(open) / float(strata);
}

void main() {
  ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(texel, imageSize(resultImage)))) return;
  ivec2 pixel = sampledPixel(texel, ivec2(every), textureSize(gPosition, 0));
  vec4 position = texelFetch(gPosition, pixel, 0);
  float open = 1.0;
  if (position.w > 0.0) open = unoccluded(pixel, position.xyz);
  // Limited to 1 last, so that values above 1 at convex edges stay in the mean over frames.
  imageStore(resultImage, texel, vec4(vec3(min(accumulate(texel, vec3(open)).r, 1.0)), 1.0));
}
