// Radiance along a cone through a store: Crassin et al. 2011, Sec. 7; thesis 004, Sec. 4.2.1, Listing 4.13 (thesis_cone_tracing has it as
// printed).
#pragma lumivox axis ENVIRONMENT 0 1
#pragma lumivox axis MEDIUM none even varying
#include "common/random.glsl"
#include "store.glsl"
#if MEDIUM != MEDIUM_NONE
#include "common/media.glsl"
#endif

// C++ side: ConeMarch in techniques/voxel_cone_tracing/cones/march.h.
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
