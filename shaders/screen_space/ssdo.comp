#version 450
// Screen-space directional occlusion (Ritschel, Grosch & Seidel 2009): unoccluded directions contribute the environment, occluded
// directions the light of the surfaces that occlude them.
#pragma lumivox axis EMISSION 0 1
#include "screen.glsl"
#include "common/environment.glsl"

const int kSolidAngle = 0, kPublished = 1;
layout(constant_id = 1) const int area = kSolidAngle;

layout(std140, binding = 0) uniform Light {
  vec3 environment;  // radiance, W/(sr m^2)
};
layout(binding = 3) uniform sampler2D directRadiance;
#if EMISSION
layout(binding = 4) uniform sampler2D gEmission;
#endif

// Direct light that a pixel's surface reflects. Its emission is excluded, because emitters already are lights of the direct light.
vec3 reflectedBy(ivec2 pixel) {
  vec3 radiance = texelFetch(directRadiance, pixel, 0).rgb;
#if EMISSION
  radiance -= texelFetch(gEmission, pixel, 0).rgb;
#endif
  return max(radiance, vec3(0.0));
}

// Contribution to E / pi of the surface in a pixel, which occludes a direction.
vec3 sentFrom(ivec2 pixel, vec3 posWorld, vec3 normal, float cosTheta) {
  vec3 toSender = texelFetch(gPosition, pixel, 0).xyz - posWorld;
  float cosSender = -dot(texelFetch(gGeometricNormal, pixel, 0).xyz, toSender);  // times the distance
  if (!(cosSender > 0.0)) return vec3(0.0);
  if (area == kSolidAngle) return reflectedBy(pixel) * (2.0 * cosTheta / float(samples));
  // L / pi A cos cos / d^2, A = pi r^2 / N.
  const float kLeast = 0.01;  // smallest d, as a share of the radius
  float distance = length(toSender), perRadius = radius / max(distance, kLeast * radius);
  float cosReceiver = max(dot(normal, toSender), 0.0) / distance;
  return reflectedBy(pixel) * (cosReceiver * cosSender / distance * perRadius * perRadius / float(samples));
}

vec3 arriving(ivec2 pixel, vec3 posWorld) {
  vec3 normal = texelFetch(gNormal, pixel, 0).xyz, sum = vec3(0.0);
  vec4 random = randomOf(pixel);
  for (int i = 0; i < samples; ++i) {
    // Directions uniform over the hemisphere, one in each stratum of the cosine. The cosines of two
    // neighbouring strata have the mean of both.
    float cosTheta = (float(i) + ((i & 1) == 0 ? random.x : 1.0 - random.x)) / float(samples);
    vec2 place = evenly(i, random.yz);
    ivec2 other;
    if (isBehindVisible(posWorld + around(normal, cosTheta, place.x) * (radius * (1.0 - place.y)), other))
      sum += sentFrom(other, posWorld, normal, cosTheta);
    else
      // Each direction stands for 2 pi / samples of the hemisphere: a cone of that width.
      sum += environmentAlong(environment, around(normal, cosTheta, place.x), sqrt(2.0 / float(samples))) * (2.0 * cosTheta / float(samples));
  }
  return sum;
}

void main() {
  ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(texel, imageSize(resultImage)))) return;
  ivec2 pixel = sampledPixel(texel, ivec2(every), textureSize(gPosition, 0));
  vec4 position = texelFetch(gPosition, pixel, 0);
  vec3 light = vec3(0.0);
  if (position.w > 0.0) light = arriving(pixel, position.xyz);
  imageStore(resultImage, texel, vec4(accumulate(texel, light), 1.0));
}
