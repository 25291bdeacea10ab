// The Phong lobe of a patch that reflects light, packed into two unused numbers of SurfaceLight. 29 bits of each are used, below bits that
// make it an ordinary float: none is a NaN or too small.
#ifndef LUMIVOX_SURFACE_LOBE
#define LUMIVOX_SURFACE_LOBE
#include "common/brdf.glsl"
#include "common/rsm.glsl"

const uint kOrdinary = 0x40000000u;     // exponent bits 10xxxxxx
const float kDirectionSteps = 2047.0;   // 11 bits for each coordinate of the octahedron: 0.06 degrees
const float kWidthSteps = 127.0;        // 7 bits for log2(exponent + 1) up to 16: within 4.5 %
const float kLargestWidth = 16.0;

// Octahedral coordinates in 0..1 (Cigolle et al. 2014, Sec. 3.3), and back.
vec2 octahedral(vec3 direction) {
  vec2 p = direction.xy / (abs(direction.x) + abs(direction.y) + abs(direction.z));
  if (direction.z < 0.0) p = (1.0 - abs(p.yx)) * vec2(p.x >= 0.0 ? 1.0 : -1.0, p.y >= 0.0 ? 1.0 : -1.0);
  return 0.5 * p + 0.5;
}
vec3 fromOctahedral(vec2 place) {
  vec2 p = 2.0 * place - 1.0;
  vec3 direction = vec3(p, 1.0 - abs(p.x) - abs(p.y));
  if (direction.z < 0.0) direction.xy = (1.0 - abs(p.yx)) * vec2(p.x >= 0.0 ? 1.0 : -1.0, p.y >= 0.0 ? 1.0 : -1.0);
  return normalize(direction);
}

float packLobe(vec3 mirror, float exponent) {
  uvec2 steps = uvec2(octahedral(mirror) * kDirectionSteps + 0.5);
  uint width = uint(clamp(log2(exponent + 1.0) / kLargestWidth, 0.0, 1.0) * kWidthSteps + 0.5);
  return uintBitsToFloat(kOrdinary | width << 22 | steps.y << 11 | steps.x);
}
// xyz mirror direction, w exponent.
vec4 unpackLobe(float word) {
  uint bits = floatBitsToUint(word);
  vec2 place = vec2(bits & 2047u, bits >> 11 & 2047u) / kDirectionSteps;
  return vec4(fromOctahedral(place), exp2(float(bits >> 22 & 127u) * (kLargestWidth / kWidthSteps)) - 1.0);
}

// Three fluxes with 7 bits each and a shared exponent of 8 bits.
float packFlux(vec3 flux) {
  float largest = max(flux.x, max(flux.y, flux.z));
  if (!(largest > 0.0)) return 0.0;
  int exponent = clamp(int(floor(log2(largest))) + 1, -120, 126);
  if (largest >= exp2(float(exponent))) ++exponent;  // the logarithm of a power of two may be off by one
  uvec3 steps = uvec3(clamp(flux * exp2(float(7 - exponent)) + 0.5, 0.0, 127.0));
  return uintBitsToFloat(kOrdinary | uint(exponent + 128) << 21 | steps.z << 14 | steps.y << 7 | steps.x);
}
vec3 unpackFlux(float word) {
  uint bits = floatBitsToUint(word);
  if (bits == 0u) return vec3(0.0);
  return vec3(bits & 127u, bits >> 7 & 127u, bits >> 14 & 127u) * exp2(float(int(bits >> 21 & 255u) - 128 - 7));
}

// The flux of a diffuse patch that looks as bright from posWorld, W. Of what the lobe reflects in all, as phongAlbedo() says, it sends
// (n + 2) / 2 cos^n of its flux at normal incidence where a diffuse patch sends the whole.
vec3 fluxTowards(SurfaceLight light, vec3 posWorld) {
  if (light.flux.w == 0.0) return light.flux.rgb;
  vec4 lobe = unpackLobe(light.normal.w);
  vec3 path = posWorld - light.positionArea.xyz;
  float cosMirror = max(dot(lobe.xyz, path) * inversesqrt(max(dot(path, path), 1e-30)), 0.0);
  float sent = 0.5 * (lobe.w + 2.0) * (lobe.w > 0.0 ? pow(cosMirror, lobe.w) : (cosMirror > 0.0 ? 1.0 : 0.0));
  float spread = phongAlbedo(lobe.w, max(dot(lobe.xyz, light.normal.xyz), 0.0));
  return max(light.flux.rgb + unpackFlux(light.flux.w) * (sent - spread), vec3(0.0));
}

#endif
