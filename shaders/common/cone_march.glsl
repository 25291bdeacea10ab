// The cones that a surface sends, and the radiance along a cone through a store: Crassin et al. 2011, Sec. 7; thesis 004, Sec. 4.2.1,
// Listings 4.11 to 4.13 (thesis_cone_tracing has them as printed). An including file includes its store before, which says
//   StoreSample      what a step looks like: rgb radiance / storeUnit times the opacity a of some length, and the opacity of the step
//   storeUnit        W/(sr m^2) that the value 1 stands for
//   coneApex, coneTangent   variables of the cone that is traced
//   vec2 insideStore(vec3 origin, vec3 direction), float finestVoxel(vec3 at), float longestStep(float size),
//   StoreSample readStore(vec3 at, vec3 direction, float size, float stride)
// as shaders/voxel_cone_tracing/cones/store.glsl explains them. Where light costs more than opacity, a store defines LIGHT_OF_STEP and says
// the light of those steps alone that count: readStore then tells the opacities, and
//   vec3 lightOfStep(vec3 at, vec3 direction, float size)   radiance / storeUnit there
#ifndef LUMIVOX_CONE_MARCH
#define LUMIVOX_CONE_MARCH
#pragma lumivox axis ENVIRONMENT 0 1
#pragma lumivox axis MEDIUM none even varying
#include "common/cones.glsl"
#include "common/random.glsl"
#if MEDIUM != MEDIUM_NONE
#include "common/media.glsl"
#endif

// C++ side: ConeMarch in techniques/voxel_cone_tracing/cones/march.h, and gather.cpp of layered_reflective_shadow_maps.
layout(std140, binding = 2) uniform March {
  vec3 environment;   // radiance of the environment
  float maxDistance;  // m
  float stepShare;    // step along a cone as a share of its diameter
  float offset;       // start of a cone along the normal, in voxels
  float startShare;   // start of a cone along its axis, in voxels
  float clearance;    // largest voxels that are read as a share of their height over the tangent plane
  float footprint;    // voxels that are read as a share of the cone's diameter
  float leastShare;   // voxels that are read where they are partly covered, as a share of those wanted
  float jitter;       // most by which a cone's first step is shorter, as a share of it
  uvec2 seed;
};

const int kMediumSteps = 8;   // most steps through a medium that varies, within one step of a cone

#if ENVIRONMENT
// What a cone that meets nothing sees of the environment: of one alike to all sides the same, whatever its axis and its width.
vec3 environmentAlong(vec3 direction, float tanHalfAngle) { return environment; }
#endif

// How far a cone's first sample is moved, [0, 1): by the pixel, the cone and the seed.
float shiftOf(uint cone) {
  return unitInterval(hash4(uvec4(gl_GlobalInvocationID.x | gl_GlobalInvocationID.y << 16, cone, seed)).xy).x;
}

// Radiance along a cone. The sample at distance t reads voxels of a size that goes with the cone's diameter there; between the levels l
// and l+1 the blend is f = size / 2^l - 1. cosTheta is the cosine between the axis and the normal.
// Deviates from Listing 4.13: voxels of half the diameter. The trilinear kernel over voxels of size s has the standard deviation
// sqrt(1/6 + 1/12) s = s / 2 along each axis, the disc of diameter d has d / 4: a footprint of 1, as published, reads twice as wide.
//
// A first step that is shorter moves all samples behind it (the jitter that thesis Sec. 4.2.1 names against banding) and leaves nothing out.
vec3 traceCone(vec3 apex, vec3 direction, float tanHalfAngle, float cosTheta, uint cone) {
  float firstShare = jitter > 0.0 ? 1.0 - jitter * shiftOf(cone) : 1.0;
  vec3 radiance = vec3(0.0);
  float opacity = 0.0;
  float share = 1.0;
  coneApex = apex;
  coneTangent = tanHalfAngle;
  float voxelSize = finestVoxel(apex);
  vec2 inside = insideStore(apex, direction);
  float distance = max(startShare * voxelSize, inside.x), end = min(maxDistance, inside.y);
#if MEDIUM != MEDIUM_NONE
  // Transmittance of the media up to the sample.
  vec3 passed = exp(-opticalDepth(apex, direction, distance, distance > startShare * voxelSize ? kMediumSteps : 1));
#else
  const float passed = 1.0;
#endif
  while (distance < end && opacity < kOpaque) {
    // Deviates from Listing 4.13: a wide cone at a slant would reach below the tangent plane and read the surface that it starts from.
    float height = offset * voxelSize + cosTheta * distance;
    float wanted = min(footprint * 2.0 * tanHalfAngle * distance, clearance * height);
    // What is partly covered is read once more by voxels of half the size, and so on; what is empty by larger ones again. Down to the
    // finest, what is closed is looked at too: a cone that leaves a surface must not take its coarse voxel for a wall.
    wanted = max(wanted * share, min(wanted, voxelSize));
    // The last step ends where the grid does, so that walls there are read in full.
    float stride = min(min(stepShare * max(wanted / footprint, voxelSize), longestStep(wanted)), end - distance) * firstShare;
    StoreSample found = readStore(apex + direction * (distance + 0.5 * stride), direction, wanted, stride);
    bool coarse = found.opacity > 0.0 && (found.opacity < kOpaque || leastShare == 0.0);
    if (coarse && wanted > voxelSize && share > leastShare) {
      share *= 0.5;
      continue;
    }
    share = min(2.0 * share, 1.0);
    firstShare = 1.0;
#if MEDIUM != MEDIUM_NONE
    vec3 thickness = opticalDepth(apex + direction * distance, direction, stride, kMediumSteps);
    passed *= exp(-0.5 * thickness);
#endif
#ifdef LIGHT_OF_STEP
    if (found.value.a > 0.0) found.value.rgb = found.value.a * lightOfStep(apex + direction * (distance + 0.5 * stride), direction, wanted);
#endif
    if (found.value.a > 0.0) {
      // Pre-multiplied radiance scales with the opacity; listing 4.13 mixes pre-multiplied and plain radiance, which this does not.
      radiance += passed * ((1.0 - opacity) * found.opacity / found.value.a * found.value.rgb);
      opacity += (1.0 - opacity) * found.opacity;
    }
#if MEDIUM != MEDIUM_NONE
    passed *= exp(-0.5 * thickness);
#endif
    distance += stride;
  }
  radiance *= storeUnit;
#if ENVIRONMENT
#if MEDIUM != MEDIUM_NONE
  if (opacity < kOpaque) passed *= exp(-opticalDepth(apex + direction * distance, direction, kNoReach, kMediumSteps));
#endif
  radiance += passed * (max(1.0 - opacity, 0.0) * environmentAlong(direction, tanHalfAngle));
#endif
  return radiance;
}

// ---- the cones that a surface sends ----

// A cone of a pixel, and what its radiance counts for in a sum.
struct Cone {
  vec3 direction;
  float tanHalfAngle;
  float cosTheta;  // between the axis and the normal
  float weight;
};

// Where in its stratum each cone of a pixel lies, along the square of the radius and around, both in turns: in the middle and at 0, or of
// a sequence that fills squares of `pattern` pixels evenly (R2: Roberts 2018).
vec2 placeInStratum(uvec2 pixel, int pattern) {
  if (pattern == 1) return vec2(0.5, 0.0);
  const vec2 kR2 = vec2(0.75487766624669276, 0.56984029099805327);
  uvec2 place = pixel % uint(pattern);
  return fract(0.5 + float(place.y * uint(pattern) + place.x) * kR2);
}

// Cone `i` of `count` of equal weight over the hemisphere.
Cone diffuseCone(int i, int count, vec3 normal, vec2 place) {
  vec3 tangent = tangentTo(normal), bitangent = cross(normal, tangent);
  Cone cone;
  cone.direction = cosineCone(i, count, place, tangent, bitangent, normal, cone.cosTheta, cone.tanHalfAngle);
  cone.weight = 1.0;
  return cone;
}

// Thesis Listing 4.12: one cone along the normal and four at 45 degrees, weighted by the cosine.
const int kPublishedCones = 5;
const float kTilted = 0.70710678118654752440;
// By what their sum is divided. The five of the listing are not divided, so that a constant environment gains radiance; here they are by the
// sum of their weights, 1 + 4 / sqrt 2.
const float kPublishedWeights = 1.0 + 4.0 * kTilted;
Cone publishedCone(int i, vec3 normal, float tanHalfAngle) {
  vec3 tangent = tangentTo(normal), bitangent = cross(normal, tangent);
  Cone cone;
  vec3 side = (i & 1) != 0 ? tangent : bitangent;
  cone.direction = i == 0 ? normal : normalize(normal + (i <= 2 ? side : -side));
  cone.tanHalfAngle = tanHalfAngle;
  cone.cosTheta = i == 0 ? 1.0 : kTilted;
  cone.weight = i == 0 ? 1.0 : kTilted;
  return cone;
}

const uint kGlossyCone = 0xffffu;  // number of the first one

// Cone `i` of the Phong lobe cos^n around the mirror direction. One cone is as wide as the lobe's solid angle; several have equal shares of the
// lobe, each as wide as its share, and those below the horizon have no weight.
Cone glossyCone(int i, int count, vec3 normal, vec3 mirror, float exponent) {
  Cone cone;
  cone.direction = mirror;
  float cosHalfAngle = cosHalfAngleOfLobe(exponent);
  if (count > 1) {
    vec3 tangent = tangentTo(mirror), bitangent = cross(mirror, tangent);
    float share = (float(i) + 0.5) / float(count), angle = float(i) * kGoldenAngle;
    float cosAxis = pow(1.0 - share, 1.0 / (exponent + 1.0)), sinAxis = sqrt(max(1.0 - cosAxis * cosAxis, 0.0));
    cone.direction = mirror * cosAxis + (tangent * cos(angle) + bitangent * sin(angle)) * sinAxis;
    // The density of the lobe there, (n + 1) / (2 pi) cos^n, times the solid angle 2 pi (1 - cos(half angle)) is the share.
    cosHalfAngle = max(1.0 - 1.0 / (float(count) * (exponent + 1.0) * pow(cosAxis, exponent)), 0.5);
  }
  cone.tanHalfAngle = tanOfHalfAngle(cosHalfAngle);
  cone.cosTheta = cone.weight = max(dot(cone.direction, normal), 0.0);
  return cone;
}

#endif
