#version 450
// View of a store through a thin lens, one cone per pixel: Crassin et al. 2011; thesis 004 Sec. 2.4, Fig. 16; Amanatides 1984.
#pragma lumivox axis ENVIRONMENT 0 1
#pragma lumivox axis MEDIUM none even varying
#include "../cones/surfaces.glsl"
#if ENVIRONMENT
#include "common/environment.glsl"
#endif
#if MEDIUM != MEDIUM_NONE
#include "common/media.glsl"
#endif

layout(local_size_x = 8, local_size_y = 8) in;

const int kSpread = 0, kDoubleCone = 1;
layout(constant_id = 0) const int widthRule = kSpread;
layout(constant_id = 1) const int asMedium = 0;

layout(std140, binding = 0) uniform Lens {
  vec3 eyeWorld;
  float aperture;     // diameter of the lens, m
  vec3 corner;        // direction through the upper left corner of the image, 1 along the view axis
  float focus;        // distance of the plane in focus along the view axis, m; not read if the aperture is 0
  vec3 perColumn;     // change of that direction from pixel to pixel
  float pixelWidth;   // of a pixel at a distance of 1 m along the view axis
  vec3 perRow;
  float stepShare;    // step along a cone as a share of its diameter
  vec3 environment;   // radiance of an unoccluded cone
  float footprint;    // size of the voxels read, as a share of the cone's diameter
};

layout(binding = 0, rgba32f) uniform writeonly image2D radianceImage;

const int kMediumSteps = 8;  // step limit through a heterogeneous medium, within one step of a cone

// Diameter of the cone at a depth along the view axis. The footprint of a pixel there is the pixel's square convolved with the disc of the
// lens, which shrinks to a point in the plane in focus.
// - kDoubleCone: two of Amanatides' cones, point to point in that plane: their diameter is the sum of those of lens and pixel. The first
//   cone has its virtual origin behind that plane, the second before it.
// - kSpread: the disc with the variance of both, D^2 / 16 = L^2 / 16 + P^2 / 12 along each axis.
// Without a lens both are one cone from the eye: the anti-aliased ray.
float diameterAt(float depth) {
  float pixel = pixelWidth * depth, lens = aperture > 0.0 ? aperture * abs(1.0 - depth / focus) : 0.0;
  if (widthRule == kDoubleCone) return lens + pixel;
  return sqrt(lens * lens + 4.0 / 3.0 * pixel * pixel);
}

vec3 radianceThrough(vec3 direction, float depthPerMetre) {
  float voxel = finestVoxel(eyeWorld);
  vec2 inside = insideStore(eyeWorld, direction);
  float distance = max(inside.x, 0.0), end = inside.y;
  Covering covering = kOpen;
  vec3 radiance = vec3(0.0);
#if MEDIUM != MEDIUM_NONE
  vec3 passed = exp(-opticalDepth(eyeWorld, direction, distance, kMediumSteps));
#else
  const float passed = 1.0;
#endif
  while (distance < end && covering.through > 1.0 - kOpaque) {
    float wanted = max(footprint * diameterAt(depthPerMetre * distance), voxel);
    float stride = min(min(stepShare * wanted / footprint, longestStep(wanted)), end - distance);
    vec3 middle = eyeWorld + direction * (distance + 0.5 * stride);
#if MEDIUM != MEDIUM_NONE
    vec3 thickness = opticalDepth(eyeWorld + direction * distance, direction, stride, kMediumSteps);
    passed *= exp(-0.5 * thickness);
#endif
    StoreSample found = readStore(middle, direction, wanted, stride);
    float share = asMedium != 0 ? coverByMedium(covering, found) : cover(covering, found, wanted, stride);
    // Radiance over opacity is the radiance of the surfaces themselves.
    if (share > 0.0) radiance += passed * (share / found.value.a * found.value.rgb);
#if MEDIUM != MEDIUM_NONE
    passed *= exp(-0.5 * thickness);
#endif
    distance += stride;
  }
  radiance *= storeUnit;
#if ENVIRONMENT
#if MEDIUM != MEDIUM_NONE
  if (covering.through > 1.0 - kOpaque) passed *= exp(-opticalDepth(eyeWorld + direction * distance, direction, kNoReach, kMediumSteps));
#endif
  // A cone that ended early, as opaque, gets no light from the environment.
  // Far away, the footprint is a cone of the lens's and the pixel's angular widths, as in diameterAt().
  if (covering.through > 1.0 - kOpaque) {
    float lens = aperture > 0.0 ? aperture / focus : 0.0;
    float width = widthRule == kDoubleCone ? lens + pixelWidth : sqrt(lens * lens + 4.0 / 3.0 * pixelWidth * pixelWidth);
    radiance += passed * (covering.through * environmentAlong(environment, direction, 0.5 * width * depthPerMetre));
  }
#endif
  return radiance;
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(radianceImage)))) return;
  vec3 direction = corner + (float(pixel.x) + 0.5) * perColumn + (float(pixel.y) + 0.5) * perRow;
  float size = length(direction);
  imageStore(radianceImage, pixel, vec4(radianceThrough(direction / size, 1.0 / size), 1.0));
}
