#version 450
// Thesis 004, Sec. 4.5, Listings 4.51 to 4.53: light that the media scatter towards the camera once, and what they leave of the light
// behind them. Deviates from Listing 4.52, which adds up scattering alone: extinction to the light and to the eye is part of the integral.
#pragma lumivox axis MEDIUM even varying
#pragma lumivox axis LIGHTS 0 1
#pragma lumivox axis LIGHT_DEPTH march volume
#pragma lumivox require MEDIUM == varying || LIGHT_DEPTH == march
#pragma lumivox require LIGHTS || LIGHT_DEPTH == march
#if LIGHTS
#define SHADOW_VIEWS
#endif
#include "range.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 0) const int stepCount = 32;
layout(constant_id = 1) const int lightSteps = 32;
layout(constant_id = 2) const int dithered = 1;
layout(constant_id = 3) const int phaseIsPublished = 0;

layout(std140, binding = 0) uniform Parameters {
  ivec2 size;      // samples
  int lightCount;
  int depthSide;   // voxels along a side of a slab of the light depths
  vec3 depthLow;   // m, box of the light depths
  vec3 depthHigh;
};
#if LIGHT_DEPTH == LIGHT_DEPTH_VOLUME
layout(binding = 12) uniform sampler3D lightDepth;
#endif
layout(binding = 0, rgba32f) uniform writeonly image2D scatteredImage;      // w: where the ray leaves the media, m
layout(binding = 1, rgba32f) uniform writeonly image2D transmittanceImage;

// Start of the first step as a share of it: the ordered 4 x 4 pattern of Bayer 1973, "An optimum method for two-level rendition", which
// counts to 15/16. Deviates from Listing 4.51: 0.25 where 0.22 is printed, and half an entry more, so that the mean is one half.
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
  vec3 share = (posWorld - depthLow) / (depthHigh - depthLow);
  if (all(greaterThanEqual(share, vec3(0.0))) && all(lessThanEqual(share, vec3(1.0)))) {
    // Slabs of other lights must not be mixed in.
    float inset = 0.5 / float(depthSide);
    share.z = (float(i) + clamp(share.z, inset, 1.0 - inset)) / float(lightCount);
    return evenDepth(posWorld, direction, reach) + textureLod(lightDepth, share, 0.0).rgb;
  }
#endif
  return opticalDepth(posWorld, direction, reach, lightSteps);
}

// Where a step is looked at for a light, and the factor from the irradiance there to what counts for the step. The inverse square of the
// distance to a light is integrated exactly, and the place is chosen evenly in the angle that the light sees (Kulla & Fajardo 2012,
// "Importance sampling techniques for path tracing in participating media", Sec. 4.1): steps may be longer than the way to the light.
float placeInStep(LightSample light, vec3 direction, float near, float stride, float share, out float factor) {
  factor = 1.0;
  if (int(light.positionKind.w) == kLightDirectional) return near + share * stride;
  vec3 path = light.positionKind.xyz - eyeWorld;
  float along = dot(path, direction);
  vec3 side = path - along * direction;
  float heightSquared = dot(side, side) + light.shape.w, height = sqrt(max(heightSquared, 1e-20));
  float first = atan((near - along) / height), last = atan((near + stride - along) / height);
  float place = clamp(along + height * tan(mix(first, last, share)), near, near + stride);
  factor = (last - first) * (heightSquared + (place - along) * (place - along)) / (height * stride);
  return place;
}

// Integral of exp(-depth) over a step of unit length along which the depth goes from a to b at an even rate: exact for any depth, so that
// one step may be as thick as it likes.
vec3 meanTransmittance(vec3 a, vec3 b) {
  vec3 change = b - a;
  vec3 exact = (exp(-a) - exp(-b)) / mix(change, vec3(1.0), lessThan(abs(change), vec3(1e-2)));
  // Series of sinh(x) / x about the middle; the next term is 1e-10.
  vec3 small = exp(-0.5 * (a + b)) * (1.0 + change * change * (1.0 / 24.0));
  return mix(exact, small, lessThan(abs(change), vec3(1e-2)));
}
#endif

void main() {
  ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(texel, size))) return;
  float reach;
  vec3 direction = rayOf(pixelOf(texel), reach);
  vec2 range = insideMedia(eyeWorld, direction, reach);
  vec3 scattered = vec3(0.0), passed = vec3(0.0);  // passed: optical depth from the eye
  float stride = max(range.y - range.x, 0.0) / float(stepCount), start = dither(texel);
  for (int s = 0; s < stepCount && stride > 0.0; ++s) {
    float near = range.x + float(s) * stride;
    vec3 posWorld = eyeWorld + direction * (near + start * stride);
    vec3 thickness = vec3(0.0);  // optical depth of the step
    for (int i = 0; i < mediumCount; ++i) {
      if (isEven(i)) {
        vec2 inside = insideMedium(i, eyeWorld, direction, near + stride);
        thickness += media[i].extinction.rgb * max(inside.y - max(inside.x, near), 0.0);
      }
#if MEDIUM == MEDIUM_VARYING
      else thickness += media[i].extinction.rgb * (densityAt(i, posWorld) * stride);
#endif
    }
#if LIGHTS
    vec3 first = eyeWorld + direction * near, last = eyeWorld + direction * (near + stride);
    for (int l = 0; l < lightCount; ++l) {
      LightSample light = lights[l];
      vec3 toLight;
      float factor;
      vec3 lit = eyeWorld + direction * placeInStep(light, direction, near, stride, start, factor);
      vec3 irradiance = factor * arrivingIrradiance(light, lit, toLight);
      vec3 scattering = vec3(0.0);  // sigma_s times phase times length
      for (int i = 0; i < mediumCount; ++i) {
        float share = 0.0;
        if (isEven(i)) {
          vec2 inside = insideMedium(i, eyeWorld, direction, near + stride);
          share = max(inside.y - max(inside.x, near), 0.0);
        }
#if MEDIUM == MEDIUM_VARYING
        else share = densityAt(i, posWorld) * stride;
#endif
        float g = media[i].lowAnisotropy.w;
        if (share <= 0.0) continue;
        float turned = phaseIsPublished != 0 ? phaseAsPublished(g, toLight, direction) : phase(g, toLight, direction);
        scattering += media[i].scattering.rgb * (share * turned);
      }
      if (all(equal(scattering * irradiance, vec3(0.0)))) continue;
      irradiance *= visibility(light, lit, toLight, toLight);
      if (all(equal(irradiance, vec3(0.0)))) continue;
      scattered += scattering * irradiance *
                   meanTransmittance(passed + depthToLight(l, first), passed + thickness + depthToLight(l, last));
    }
#endif
    passed += thickness;
  }
  imageStore(scatteredImage, texel, vec4(scattered, range.x < range.y ? range.y : 0.0));
  imageStore(transmittanceImage, texel, vec4(exp(-passed), 1.0));
}
