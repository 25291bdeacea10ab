// The cones that a surface sends, and the radiance along a cone through a store: Crassin et al. 2011, Sec. 7; thesis 004, Sec. 4.2.1,
// Listings 4.11 to 4.13 (thesis_cone_tracing has them as printed). An including file first includes its store, which declares
//   StoreSample      a step: rgb radiance / storeUnit times the opacity a of some length, and the opacity of the step
//   storeUnit        W/(sr m^2) that the value 1 stands for
//   coneApex, coneTangent   variables of the cone that is traced
//   vec2 insideStore(vec3 origin, vec3 direction), float finestVoxel(vec3 at), float longestStep(float size),
//   StoreSample readStore(vec3 at, vec3 direction, float size, float stride)
// as shaders/voxel_cone_tracing/cones/store.glsl explains them. If light costs more to read than opacity, a store defines LIGHT_OF_STEP.
// readStore then returns the opacities only, and light is read only for the steps that count, by
//   vec3 lightOfStep(vec3 at, vec3 direction, float size)   radiance / storeUnit there
#ifndef LUMIVOX_CONE_MARCH
#define LUMIVOX_CONE_MARCH
#pragma lumivox axis ENVIRONMENT 0 1
#pragma lumivox axis MEDIUM none even varying
#include "common/cones.glsl"
#include "common/random.glsl"
#if ENVIRONMENT
#include "common/environment.glsl"
#endif
#if MEDIUM != MEDIUM_NONE
#include "common/media.glsl"
#endif

// C++ side: ConeMarch in techniques/voxel_cone_tracing/cones/march.h, and gather.cpp of layered_reflective_shadow_maps.
layout(std140, binding = 2) uniform March {
  vec3 environment;   // mean radiance of the environment
  float maxDistance;  // m
  float stepShare;    // step along a cone as a share of its diameter
  float offset;       // start of a cone along the normal, in voxels
  float startShare;   // start of a cone along its axis, in voxels
  float clearance;    // largest size of the voxels read, as a share of the sample's height over the tangent plane
  float footprint;    // size of the voxels read, as a share of the cone's diameter
  float leastShare;   // smallest size of the voxels read where they are partly covered, as a share of the wanted size
  float jitter;       // largest share by which a cone's first step is shortened
  uvec2 seed;
};

const int kMediumSteps = 8;   // step limit through a heterogeneous medium, within one step of a cone

// Random shift of a cone's first sample, [0, 1): depends on the pixel, the cone and the seed.
float shiftOf(uint cone) {
  return unitInterval(hash4(uvec4(gl_GlobalInvocationID.x | gl_GlobalInvocationID.y << 16, cone, seed)).xy).x;
}

// Radiance along a cone. The sample at distance t reads voxels of a size proportional to the cone's diameter there; between the levels l
// and l+1 the blend is f = size / 2^l - 1. cosTheta is the cosine between the axis and the normal.
// Deviates from Listing 4.13: voxels have half the diameter. The trilinear kernel over voxels of size s has the standard deviation
// sqrt(1/6 + 1/12) s = s / 2 along each axis; the disc of diameter d has d / 4. The published footprint of 1 thus reads twice as wide.
//
// A shorter first step moves all samples behind it and skips no part of the cone: the jitter against banding of thesis Sec. 4.2.1.
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
    // Deviates from Listing 4.13, where a wide slanted cone reaches below the tangent plane and reads the surface that it starts from.
    float height = offset * voxelSize + cosTheta * distance;
    float wanted = min(footprint * 2.0 * tanHalfAngle * distance, clearance * height);
    // Where voxels are partly covered, the step is read again with voxels of half the size, and so on; behind empty steps voxels grow
    // again. If leastShare is 0, this goes down to the finest voxels, opaque ones included: a cone that leaves a surface must not take its
    // own coarse voxel for a wall.
    wanted = max(wanted * share, min(wanted, voxelSize));
    // The last step ends at the border of the grid, so that walls there are read in full.
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
      // Pre-multiplied radiance scales with the opacity. Deviates from Listing 4.13, which mixes pre-multiplied and plain radiance.
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
  radiance += passed * (max(1.0 - opacity, 0.0) * environmentAlong(environment, direction, tanHalfAngle));
#endif
  return radiance;
}

// ---- the cones that a surface sends ----

// A cone of a pixel, and the weight of its radiance in a sum.
struct Cone {
  vec3 direction;
  float tanHalfAngle;
  float cosTheta;  // between the axis and the normal
  float weight;
};

// Position of each cone of a pixel in its stratum: x along the square of the radius, y around as a fraction of a turn. It is (0.5, 0), or a
// point of a sequence that fills squares of `pattern` pixels evenly (R2: Roberts 2018).
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
// Sum of the weights, 1 + 4 / sqrt 2, by which the sum of the cones is divided. The listing does not
// divide, so that a constant environment gains radiance.
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

const uint kGlossyCone = 0xffffu;  // number of the first glossy cone

// Cone `i` of the Phong lobe cos^n around the mirror direction. A single cone has the solid angle of the lobe. Several cones have equal
// shares of the lobe, and each covers the solid angle of its share; cones below the horizon have weight 0.
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
