#version 450
// Light of the volume that visible surfaces reflect, or their openness: Mavridis & Papaioannou 2011, Sec. 3.4 and 3.5, Eq. 4 and 6.
#pragma lumivox axis OF light openness
layout(local_size_x = 8, local_size_y = 8) in;
#if OF == OF_LIGHT
#define VOLUMES 3
#else
#define VOLUMES 1
#endif
#include "reconstruct.glsl"
#if OF == OF_LIGHT
#include "common/environment.glsl"
#endif
layout(constant_id = 0) const int closure = 0;  // 1: keeps the difference of both sides, and makes neither negative

layout(std140, binding = 0) uniform Gathering {
  vec3 environment;  // W/(sr m^2)
  float unit;        // physical value of the number 1 of the volume
};
layout(binding = 0) uniform sampler2D gPosition;
layout(binding = 1) uniform sampler2D gNormal;
layout(binding = 2) uniform sampler2D gGeometricNormal;
#if OF == OF_LIGHT
layout(binding = 3) uniform sampler2D gDiffuse;
layout(binding = 0, rgba32f) uniform writeonly image2D diffuseImage;
layout(binding = 1, rgba32f) uniform writeonly image2D clippedImage;
#else
layout(binding = 0, rgba32f) uniform writeonly image2D occlusionImage;
#endif

// Irradiance over pi from both bands. `clipped`: its negative part before clamping or closure, as a positive value.
float meanRadiance(vec4 coefficients, vec3 normal, out float clipped) {
  vec4 cosine = shClampedCosine(normal);
  float mean = coefficients.x * cosine.x / kPi, net = dot(coefficients.yzw, cosine.yzw) / kPi;
  clipped = max(-(mean + net), 0.0);
  if (closure == 0) return max(mean + net, 0.0);
  float larger = max(max(abs(mean), abs(net)), 1e-30);
  return max(larger * sqrt((mean / larger) * (mean / larger) + (net / larger) * (net / larger)) + net, 0.0);
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, textureSize(gPosition, 0)))) return;
  vec4 posWorld = texelFetch(gPosition, pixel, 0);
  precise vec3 surface = (posWorld.xyz - gridLow) / voxelSize;  // equal, to the bit, to mark_surfaces.comp
  vec3 normal = texelFetch(gNormal, pixel, 0).xyz;
  bool isSurface = posWorld.w > 0.0, isInside = isInVolume(surface);
  Arriving arriving;
  if (isSurface && isInside) arriving = arrivingAt(surface, texelFetch(gGeometricNormal, pixel, 0).xyz);
#if OF == OF_LIGHT
  // Outside the volume, only the environment is reflected.
  const float kTanOfPi = 1.7320508;  // of a cone of pi sr, the projected solid angle of a hemisphere
  vec3 reflected = isSurface ? environmentAlong(environment, normal, kTanOfPi) : vec3(0.0), cut = vec3(0.0);
  if (isSurface && isInside)
    for (int channel = 0; channel < 3; ++channel)
      reflected[channel] = meanRadiance(arriving.volumes[channel] * unit, normal, cut[channel]);
  vec3 albedo = texelFetch(gDiffuse, pixel, 0).rgb;
  imageStore(diffuseImage, pixel, vec4(albedo * reflected, 1.0));
  imageStore(clippedImage, pixel, vec4(albedo * cut, 1.0));
#else
  float cut, open = 1.0;
  if (isSurface && isInside) open = min(meanRadiance(arriving.volumes[0] * unit, normal, cut), 1.0);
  imageStore(occlusionImage, pixel, vec4(vec3(open), 1.0));
#endif
}
