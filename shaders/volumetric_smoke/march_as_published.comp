#version 450
// Thesis 004, Sec. 4.5, Listings 4.51 to 4.53 as printed; march.comp is our version. Deviates: a ray that meets no surface ends behind the
// media; the print reads the position of such a pixel from an empty g-buffer.
#pragma lumivox axis MEDIUM even varying
#define SHADOW_VIEWS
#include "range.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 0) const int stepCount = 32;
layout(constant_id = 1) const int ditherIsPublished = 1;
layout(constant_id = 2) const int cosineIsPublished = 1;
layout(constant_id = 3) const int phaseIsPublished = 1;

layout(std140, binding = 0) uniform Parameters {
  ivec2 size;        // samples
  int lightCount;
  float unit;        // m, unit of the printed lengths: half the longest side of the scene
  vec3 sceneCentre;  // m, origin of the printed positions
  vec4 amountPerDensity[2];  // per medium: particles in a voxel; 1 for media without particles
};
layout(binding = 0, rgba32f) uniform writeonly image2D scatteredImage;  // w: where the ray leaves the media, m

// Listing 4.51: pixels count from the lower left, and their column selects a printed row of the matrix, in GLSL a column.
float dither(ivec2 texel) {
  float slip = ditherIsPublished != 0 ? 0.22 : 0.25;
  mat4 pattern = mat4(0.0, 0.5, 0.125, 0.625, 0.75, slip, 0.875, 0.375, 0.1875, 0.6875, 0.0625, 0.5625, 0.9375, 0.4375, 0.8125, 0.3125);
  return pattern[texel.x & 3][(size.y - 1 - texel.y) & 3];
}

// The amount that Listing 4.52 finds in the grid: at most one particle counts.
float amountAt(vec3 posWorld) {
  float amount = 0.0;
  for (int i = 0; i < mediumCount; ++i) {
    if (any(lessThan(posWorld, media[i].lowAnisotropy.xyz)) || any(greaterThan(posWorld, media[i].highDensity.xyz))) continue;
    float density = 1.0;
#if MEDIUM == MEDIUM_VARYING
    if (!isEven(i)) density = densityAt(i, posWorld);
#endif
    amount += density * amountPerDensity[i / 4][i % 4];
  }
  return clamp(amount, 0.0, 1.0);
}

// Listing 4.53. The printed cosine of vectors without unit length can make the base negative; the power
// is then undefined, and nothing is added.
float scattering(float cosine, float g) {
  float base = 1.0 + g * g - 2.0 * g * cosine;
  if (base <= 0.0) return 0.0;
  return (1.0 - g) * (phaseIsPublished != 0 ? 1.0 - g : 1.0 + g) / (4.0 * kPi * base * sqrt(base));
}

void main() {
  ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(texel, size))) return;
  float reach;
  vec3 direction = rayOf(pixelOf(texel), reach);
  vec2 range = insideMedia(eyeWorld, direction, reach);
  vec3 scattered = vec3(0.0);
  if (range.x < range.y) {
    float rayLength = reach == kNoReach ? range.y : reach, stride = rayLength / float(stepCount), start = stride * dither(texel);
    for (int s = 0; s < stepCount; ++s) {
      vec3 posWorld = eyeWorld + direction * (start + float(s) * stride);
      float g = 1.0 - amountAt(posWorld);
      for (int i = 0; i < lightCount; ++i) {
        LightSample light = lights[i];
        vec3 toLight;
        vec3 irradiance = arrivingIrradiance(light, posWorld, toLight);
        if (visibility(light, posWorld, toLight, toLight) <= 0.0) continue;
        float cosine = dot(direction, toLight);
        if (cosineIsPublished != 0) {
          bool directional = light.kind == kLightDirectional;  // no position: one unit towards it
          vec3 lightPosition = directional ? toLight : (light.position - sceneCentre) / unit;
          cosine = dot(direction * (rayLength / unit), lightPosition);
        }
        scattered += scattering(cosine, g) * irradiance;
      }
    }
    scattered /= float(stepCount);
  }
  imageStore(scatteredImage, texel, vec4(scattered, range.x < range.y ? range.y : 0.0));
}
