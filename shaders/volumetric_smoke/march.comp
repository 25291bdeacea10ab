#version 450
// Thesis 004, Sec. 4.5, Listings 4.51 to 4.53: single scattering by the media towards the camera, and the transmittance of the media.
// Deviates from Listing 4.52, which sums scattering only: here extinction towards the light and towards the eye is part of the integral.
#pragma lumivox axis MEDIUM even varying
#pragma lumivox axis LIGHTS 0 1
#pragma lumivox axis LIGHT_DEPTH march volume
#pragma lumivox require MEDIUM == varying || LIGHT_DEPTH == march
#pragma lumivox require LIGHTS || LIGHT_DEPTH == march
#if LIGHTS
#define SHADOW_VIEWS
#endif
#include "range.glsl"
#include "cells.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 0) const int stepCount = 32;
layout(constant_id = 1) const int lightSteps = 32;
layout(constant_id = 2) const int dithered = 1;
layout(constant_id = 3) const int phaseIsPublished = 0;
layout(constant_id = 4) const int exactCells = 8;  // 0: densities are sampled once per step, as published

layout(std140, binding = 0) uniform Parameters {
  ivec2 size;      // samples
  int lightCount;
  int gridSide;    // points along a side of a slab of the transmittances to the lights
  vec3 gridLow;    // box of these points, m
  vec3 gridHigh;
  float nearReach; // m; distance towards a light that is integrated before the transmittances are read
};
#if LIGHT_DEPTH == LIGHT_DEPTH_VOLUME
layout(binding = 12) uniform sampler3D lightTransmittance;
#endif
layout(binding = 0, rgba32f) uniform writeonly image2D scatteredImage;      // w: where the ray leaves the media, m
layout(binding = 1, rgba32f) uniform writeonly image2D transmittanceImage;

// Offset of the first sample as a share of the step: the ordered 4 x 4 pattern of Bayer 1973, "An optimum method for two-level rendition",
// which counts to 15/16. Deviates from Listing 4.51: 0.25 where 0.22 is printed, and half an entry is added, so that the mean is one half.
float dither(ivec2 texel) {
  if (dithered == 0) return 0.5;
  int x = texel.x & 3, y = texel.y & 3, exclusive = x ^ y;
  int rank = (exclusive & 1) << 3 | (y & 1) << 2 | (exclusive & 2) | (y & 2) >> 1;
  return (float(rank) + 0.5) / 16.0;
}

#if LIGHTS
// Optical depth of all media between a point and a light sample.
vec3 depthToLight(int i, vec3 posWorld) {
  vec3 direction;
  float reach;
  wayToLight(lights[i], posWorld, direction, reach);
#if LIGHT_DEPTH == LIGHT_DEPTH_VOLUME
  // The grid is too coarse for the surface of thick smoke: the near part of the path is integrated, and
  // the transmittance of the rest is read.
  vec3 depth = evenDepth(posWorld, direction, reach);
  float way = min(nearReach, reach), reached;
  for (int m = 0; m < mediumCount; ++m) {
    vec2 inside = insideMedium(m, posWorld, direction, way);
    if (isEven(m) || inside.x >= inside.y) continue;
    depth += media[m].extinction.rgb * integralOverCells(m, posWorld, direction, inside, kAllCells, reached);
  }
  if (way == reach) return depth;
  vec3 share = (posWorld + direction * way - gridLow) / (gridHigh - gridLow);
  if (any(lessThan(share, vec3(0.0))) || any(greaterThan(share, vec3(1.0))))
    return depth + varyingDepth(posWorld + direction * way, direction, reach - way, lightSteps);
  // Slabs of other lights must not be mixed in.
  float inset = 0.5 / float(gridSide);
  share.z = (float(i) + clamp(share.z, inset, 1.0 - inset)) / float(lightCount);
  return depth - log(max(textureLod(lightTransmittance, share, 0.0).rgb, vec3(kLeastTransmittance)));
#elif MEDIUM == MEDIUM_VARYING
  if (exactCells > 0) return depthFrom(posWorld, direction, reach, exactCells, lightSteps);
#endif
  return opticalDepth(posWorld, direction, reach, lightSteps);
}

// Sample position of a step for a light, and `factor` on the irradiance there. The inverse square of the distance to the light is
// integrated exactly, and the position is uniform in the angle seen from the light (Kulla & Fajardo 2012, "Importance sampling techniques
// for path tracing in participating media", Sec. 4.1): steps may be longer than the distance to the light.
float placeInStep(LightSample light, vec3 direction, float near, float stride, float share, out float factor) {
  factor = 1.0;
  if (light.kind == kLightDirectional) return near + share * stride;
  vec3 path = light.position - eyeWorld;
  float along = dot(path, direction);
  vec3 side = path - along * direction;
  float heightSquared = dot(side, side) + light.patchRadiusSquared, height = sqrt(max(heightSquared, 1e-20));
  float first = atan((near - along) / height), last = atan((near + stride - along) / height);
  float place = clamp(along + height * tan(mix(first, last, share)), near, near + stride);
  factor = (last - first) * (heightSquared + (place - along) * (place - along)) / (height * stride);
  return place;
}

// Integral of exp(-depth) over a step of unit length along which the depth changes linearly from a to
// b: exact, so that a step may have any optical depth.
vec3 meanTransmittance(vec3 a, vec3 b) {
  vec3 change = b - a;
  vec3 exact = (exp(-a) - exp(-b)) / mix(change, vec3(1.0), lessThan(abs(change), vec3(1e-2)));
  // Series of sinh(x) / x about the middle; the next term is 1e-10.
  vec3 small = exp(-0.5 * (a + b)) * (1.0 + change * change * (1.0 / 24.0));
  return mix(exact, small, lessThan(abs(change), vec3(1e-2)));
}
#endif

// Length of a step inside a medium times the mean density there, m. For heterogeneous media: exact over the cells at the step's far end,
// where the depth to the light is evaluated, and by one sample over the rest.
float amountInStep(int i, vec3 direction, float near, float stride, float start) {
  if (isEven(i)) {
    vec2 inside = insideMedium(i, eyeWorld, direction, near + stride);
    return max(inside.y - max(inside.x, near), 0.0);
  }
#if MEDIUM == MEDIUM_VARYING
  float reached = 0.0, sum = 0.0;
  if (exactCells > 0) sum = integralOverCells(i, eyeWorld + direction * (near + stride), -direction, vec2(0.0, stride), exactCells, reached);
  float rest = stride - reached;
  return rest > 0.0 ? sum + rest * densityAt(i, eyeWorld + direction * (near + start * rest)) : sum;
#endif
  return 0.0;
}

void main() {
  ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(texel, size))) return;
  float reach;
  vec3 direction = rayOf(pixelOf(texel), reach);
  vec2 range = insideMedia(eyeWorld, direction, reach);
  vec3 scattered = vec3(0.0), passed = vec3(0.0);  // passed: optical depth from the eye
  float stride = max(range.y - range.x, 0.0) / float(stepCount), start = dither(texel);
#if LIGHTS
  for (int l = 0; l < lightCount; ++l) {
    LightSample light = lights[l];
    vec3 atNear, atFar;  // depths to the light
    bool known = false;  // atNear is known: the depth at the far end of the previous step
    passed = vec3(0.0);
#endif
    for (int s = 0; s < stepCount && stride > 0.0 && any(lessThan(passed, vec3(kOpaque))); ++s) {
      float near = range.x + float(s) * stride;
#if LIGHTS
      vec3 toLight;
      float factor;
      vec3 lit = eyeWorld + direction * placeInStep(light, direction, near, stride, start, factor);
      vec3 irradiance = factor * arrivingIrradiance(light, lit, toLight);
      vec3 scattering = vec3(0.0);  // sigma_s times phase times length
#endif
      vec3 thickness = vec3(0.0);  // optical depth of the step
      for (int i = 0; i < mediumCount; ++i) {
        float amount = amountInStep(i, direction, near, stride, start);
        if (amount <= 0.0) continue;
        thickness += media[i].extinction.rgb * amount;
#if LIGHTS
        float g = media[i].lowAnisotropy.w;
        float turned = phaseIsPublished != 0 ? phaseAsPublished(g, toLight, direction) : phase(g, toLight, direction);
        scattering += media[i].scattering.rgb * (amount * turned);
#endif
      }
#if LIGHTS
      if (any(notEqual(scattering * irradiance, vec3(0.0)))) irradiance *= visibility(light, lit, toLight, toLight);
      scattering *= irradiance;
      if (all(equal(scattering, vec3(0.0)))) {
        known = false;
      } else {
        if (!known) atNear = depthToLight(l, eyeWorld + direction * near);
        atFar = depthToLight(l, eyeWorld + direction * (near + stride));
        scattered += scattering * meanTransmittance(passed + atNear, passed + thickness + atFar);
        atNear = atFar;
        known = true;
      }
#endif
      passed += thickness;
    }
#if LIGHTS
  }
#endif
  imageStore(scatteredImage, texel, vec4(scattered, range.x < range.y ? range.y : 0.0));
  imageStore(transmittanceImage, texel, vec4(exp(-passed), 1.0));
}
