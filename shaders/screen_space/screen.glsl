// Points around a visible surface, tested against the image: whether a visible surface lies in front of them.
#include "common/cones.glsl"
#include "common/random.glsl"
#include "common/sampled_pixels.glsl"

const int kPlane = 0, kDepth = 1;
layout(constant_id = 0) const int surface = kPlane;

layout(local_size_x = 8, local_size_y = 8) in;

layout(std140, binding = 1) uniform Screen {
  vec3 eye;
  float tanHalfFov;  // of the vertical field of view
  vec3 right;
  float radius;      // of the sphere around a surface point, m
  vec3 up;
  int samples;
  vec3 forward;
  int every;         // pixels from one texel of the result to the next
  vec2 shift;        // sub-pixel shift of the image plane, pixels
  int accumulated;   // number of results whose mean is `before`
  uvec2 seed;
};
layout(binding = 0) uniform sampler2D gPosition;
layout(binding = 1) uniform sampler2D gNormal;
layout(binding = 2) uniform sampler2D gGeometricNormal;

#pragma lumivox axis ACCUMULATED 0 1
#if ACCUMULATED
layout(binding = 7) uniform sampler2D before;
#endif
layout(binding = 0, rgba32f) uniform writeonly image2D meanImage;
layout(binding = 1, rgba32f) uniform writeonly image2D resultImage;

// Four random numbers in [0, 1) per pixel; with accumulation they differ from frame to frame.
vec4 randomOf(ivec2 pixel) {
  uvec4 words = hash4(uvec4(uint(pixel.x) | uint(pixel.y) << 16u, uint(accumulated), seed));
  return vec4(unitInterval(words.xy), unitInterval(words.zw));
}

// The i-th point of a sequence that fills the unit square evenly (R2: Roberts 2018), shifted by `start`.
vec2 evenly(int i, vec2 start) {
  const vec2 kR2 = vec2(0.75487766624669276, 0.56984029099805327);
  return fract(start + float(i) * kR2);
}

// A unit vector with this cosine to a normal, at this fraction of a turn around it.
vec3 around(vec3 normal, float cosTheta, float turn) {
  vec3 tangent = tangentTo(normal), bitangent = cross(normal, tangent);
  float sinTheta = sqrt(max(1.0 - cosTheta * cosTheta, 0.0)), angle = 2.0 * kPi * turn;
  return normal * cosTheta + (tangent * cos(angle) + bitangent * sin(angle)) * sinTheta;
}

float depthOf(vec3 posWorld) { return dot(posWorld - eye, forward); }

// Whether a point lies behind a visible surface, and the pixel of that surface; false outside the view.
bool isBehindVisible(vec3 posWorld, out ivec2 pixel) {
  pixel = ivec2(-1);
  float depth = depthOf(posWorld);
  if (!(depth > 0.0)) return false;
  ivec2 size = textureSize(gPosition, 0);
  vec3 fromEye = posWorld - eye;
  vec2 slope = vec2(dot(fromEye, right), -dot(fromEye, up)) / (depth * tanHalfFov);
  vec2 place = 0.5 * vec2(size) + 0.5 * float(size.y) * slope - shift;
  // Tested as floats: positions far outside overflow an integer.
  if (any(lessThan(place, vec2(0.0))) || any(greaterThanEqual(place, vec2(size)))) return false;
  pixel = ivec2(place);
  vec4 seen = texelFetch(gPosition, pixel, 0);
  if (seen.w == 0.0) return false;
  if (surface == kDepth) return depth > depthOf(seen.xyz);
  // The visible surface continues as a plane to the edges of the pixel; its normal faces the camera.
  return dot(posWorld - seen.xyz, texelFetch(gGeometricNormal, pixel, 0).xyz) < 0.0;
}

// With accumulation, the mean over the frames; otherwise the value.
vec3 accumulate(ivec2 texel, vec3 value) {
#if ACCUMULATED
  vec3 mean = texelFetch(before, texel, 0).rgb;
  value = mean + (value - mean) / float(accumulated + 1);
#endif
  imageStore(meanImage, texel, vec4(value, 1.0));
  return value;
}
