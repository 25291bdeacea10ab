#version 450
// One level of an edge-avoiding wavelet filter (Dammertz et al. 2010) whose weights follow the light's own variance (Schied et al. 2017,
// Sec. 4.3 and 4.4): 5 x 5 samples that lie `apart` pixels apart.
#pragma lumivox axis REFLECTS 0 1  // the light is multiplied by the diffuse albedo, last
#include "common/joint_bilateral.glsl"
#include "luminance.glsl"

const int kPlane = 0, kDepth = 1;
layout(constant_id = 0) const int guide = kPlane;
layout(constant_id = 1) const int ofBoth = 1;  // 1: luminances differ in deviations of both pixels; 0: of the one that is filtered

layout(local_size_x = 8, local_size_y = 8) in;

layout(std140, binding = 0) uniform Level {
  vec3 eye;
  float pixelAngle;  // width of a pixel at a distance of 1
  vec3 forward;
  int apart;  // pixels from one sample to the next
  vec3 right;
  float sigmaLight;
  vec3 up;
  float sigmaNormal;
  float sigmaDepth;
  float tolerance;  // distance from the pixel's plane, in widths of a pixel, at which a weight is 1/e
};
layout(binding = 0) uniform sampler2D gPosition;
layout(binding = 1) uniform sampler2D gNormal;
layout(binding = 2) uniform sampler2D gGeometricNormal;
#if REFLECTS
layout(binding = 3) uniform sampler2D gDiffuse;
#endif
layout(binding = 4) uniform sampler2D lightImage;
layout(binding = 5) uniform sampler2D varianceImage;
layout(binding = 0, rgba32f) uniform writeonly image2D filteredLight;
layout(binding = 1, rgba32f) uniform writeonly image2D filteredVariance;

const float kSpline[3] = float[](3.0 / 8.0, 1.0 / 4.0, 1.0 / 16.0);  // B3

// Variance of the light around a pixel: 3 x 3 Gaussian.
float varianceAround(ivec2 at) {
  ivec2 end = textureSize(gPosition, 0) - 1;
  float sum = 0.0, weights = 0.0;
  for (int y = max(at.y - 1, 0); y <= min(at.y + 1, end.y); ++y)
    for (int x = max(at.x - 1, 0); x <= min(at.x + 1, end.x); ++x) {
      if (!(texelFetch(gPosition, ivec2(x, y), 0).w > 0.0)) continue;
      float weight = 1.0 / float((1 + abs(x - at.x)) * (1 + abs(y - at.y)));
      sum += weight * texelFetch(varianceImage, ivec2(x, y), 0).x;
      weights += weight;
    }
  return sum / weights;
}

// Change of depth along the axis of view over a pixel to the right and one down, on the plane through a position. With p = z d and d the
// ray of the pixel, of depth 1, z = c / (d . n), so that dz = -z (dd . n) / (d . n).
vec2 depthSlope(vec3 position, float depth, vec3 normal) {
  vec3 ray = (position - eye) / depth;
  float across = dot(ray, normal);
  if (abs(across) < 1e-4) across = across < 0.0 ? -1e-4 : 1e-4;
  return -depth * pixelAngle * vec2(dot(right, normal), -dot(up, normal)) / across;
}

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy), end = textureSize(gPosition, 0) - 1;
  if (any(greaterThan(at, end))) return;
  vec4 position = texelFetch(gPosition, at, 0);
  vec3 light = vec3(0.0);
  float variance = 0.0;
  if (position.w > 0.0) {
    vec3 normal = texelFetch(gNormal, at, 0).xyz, plane = texelFetch(gGeometricNormal, at, 0).xyz, own = texelFetch(lightImage, at, 0).rgb;
    float depth = dot(position.xyz - eye, forward), width = tolerance * pixelAngle * distance(position.xyz, eye);
    vec2 slope = depthSlope(position.xyz, depth, plane);
    float bright = luminanceOf(own), noise = varianceAround(at);
    float weights = 0.0;
    for (int y = -2; y <= 2; ++y)
      for (int x = -2; x <= 2; ++x) {
        ivec2 texel = at + apart * ivec2(x, y);
        if (any(lessThan(texel, ivec2(0))) || any(greaterThan(texel, end))) continue;
        vec4 other = texelFetch(gPosition, texel, 0);
        if (!(other.w > 0.0)) continue;
        vec3 value = texelFetch(lightImage, texel, 0).rgb;
        float weight = kSpline[abs(x)] * kSpline[abs(y)], otherNoise = texelFetch(varianceImage, texel, 0).x;
        if (x != 0 || y != 0) {
          float range = sigmaLight * sqrt(max(ofBoth != 0 ? 0.5 * (noise + otherNoise) : noise, 0.0)) + 1e-6 * bright + 1e-20;
          float unlike = abs(luminanceOf(value) - bright) / range;
          float steep = abs(dot(slope, vec2(apart * ivec2(x, y))));
          if (guide == kDepth)
            unlike += abs(dot(other.xyz - eye, forward) - depth) / (sigmaDepth * steep + 1e-4 * depth);
          else
            unlike += unlikeSurface(other.xyz, plane, position.xyz, plane, width, 0.0);
          weight *= pow(max(dot(normal, texelFetch(gNormal, texel, 0).xyz), 0.0), sigmaNormal) * exp(-unlike);
        }
        light += weight * value;
        variance += weight * weight * otherNoise;
        weights += weight;
      }
    light /= weights;
    variance /= weights * weights;
  }
#if REFLECTS
  light *= texelFetch(gDiffuse, at, 0).rgb;
#endif
  imageStore(filteredLight, at, vec4(light, position.w > 0.0 ? 1.0 : 0.0));
  imageStore(filteredVariance, at, vec4(vec3(variance), 1.0));
}
