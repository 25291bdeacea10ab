#version 450
// Crassin et al. 2011, Sec. 7: final gathering with a few wide cones, and one narrow cone for glossy light.
// Thesis 004, Sec. 4.2.1, Listings 4.11 to 4.13.
#pragma lumivox axis DIFFUSE 0 1
#pragma lumivox axis GLOSSY 0 1
#pragma lumivox axis ENVIRONMENT 0 1
#pragma lumivox axis MEDIUM none even varying
#pragma lumivox require DIFFUSE || GLOSSY
#include "common/cones.glsl"
#include "common/random.glsl"
#if MEDIUM != MEDIUM_NONE
#include "common/media.glsl"
#endif

layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 0) const int coneCount = 6;
layout(constant_id = 1) const int publishedCones = 0;
layout(constant_id = 2) const int asPublished = 0;
layout(constant_id = 3) const int opacityOfFinestVoxel = 0;  // 1: what RadianceGrid::Opacity::ofFinestVoxel says

layout(std140, binding = 0) uniform Parameters {
  vec3 gridLow;       // m
  float voxelSize;    // m
  vec3 gridExtent;    // m
  float stepShare;    // step along a cone as a share of its diameter
  vec3 eyeWorld;
  float maxDistance;  // m
  vec3 environment;   // radiance of a cone that meets nothing
  float offset;       // start of a cone along the normal, in voxels
  float startShare;   // start of a cone along its axis, in voxels
  float coarsest;     // coarsest level
  float clearance;    // largest voxels that are read as a share of their height over the tangent plane
  float unit;         // W/(sr m^2) that the value 1 of the grid stands for
  float footprint;    // voxels that are read as a share of the cone's diameter
  float coneRatio;    // diameter of one of the five cones over its height
  float jitter;       // most by which a cone's first step is shorter, as a share of it
  uvec2 seed;
};
layout(binding = 0) uniform sampler2D gPosition;
layout(binding = 1) uniform sampler2D gNormal;
layout(binding = 2) uniform sampler2D gGeometricNormal;
layout(binding = 4) uniform sampler3D radianceGrid;
#if DIFFUSE
layout(binding = 3) uniform sampler2D gDiffuse;
layout(binding = 0, rgba32f) uniform writeonly image2D diffuseImage;
#endif
#if GLOSSY
layout(binding = 5) uniform sampler2D gSpecular;
layout(binding = 1, rgba32f) uniform writeonly image2D glossyImage;
#endif

const int kMediumSteps = 8;   // most steps through a medium that varies, within one step of a cone

vec2 insideGrid(vec3 origin, vec3 direction) { return insideVolume(gridLow, gridExtent, origin, direction); }

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
  vec2 inside = insideGrid(apex, direction);
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
    // The last step ends where the grid does, so that walls there are read in full.
    float stride = min(stepShare * max(wanted / footprint, voxelSize), end - distance) * firstShare;
    firstShare = 1.0;
    vec3 texcoord = (apex + direction * (distance + 0.5 * stride) - gridLow) / gridExtent;
#if MEDIUM != MEDIUM_NONE
    vec3 sampled = apex + direction * distance;
    vec3 thickness = opticalDepth(sampled, direction, stride, kMediumSteps);
    passed *= exp(-0.5 * thickness);
#endif
    float blend, level = levelOf(max(wanted / voxelSize, 1.0), coarsest, blend);
    vec4 value = textureLod(radianceGrid, texcoord, level + blend);
    if (value.a > 0.0) {
      // Pre-multiplied radiance scales with the opacity; listing 4.13 mixes pre-multiplied and plain radiance, which this does not. Plain means
      // keep the opacity of a uniform medium at every level: it stays that of a finest voxel.
      float through = max(1.0 - value.a, 0.0);
      float stepOpacity = opacityOfFinestVoxel != 0 ? stepOpacityOf(through, stride / voxelSize)
                                                    : stepOpacityOf(throughVoxel(through, blend), stride / (exp2(level) * voxelSize));
      radiance += passed * ((1.0 - opacity) * stepOpacity / value.a * value.rgb);
      opacity += (1.0 - opacity) * stepOpacity;
    }
#if MEDIUM != MEDIUM_NONE
    passed *= exp(-0.5 * thickness);
#endif
    distance += stride;
  }
  radiance *= unit;
#if ENVIRONMENT
#if MEDIUM != MEDIUM_NONE
  if (opacity < kOpaque) passed *= exp(-opticalDepth(apex + direction * distance, direction, kNoReach, kMediumSteps));
#endif
  radiance += passed * (max(1.0 - opacity, 0.0) * environment);
#endif
  return radiance;
}

// Listing 4.13 as printed, lengths in metres in place of shares of the grid. A sample is two finest voxels wide or as wide as the cone, and
// is taken where its step begins. The exponent of the opacity correction is half of its diameter over the first one's: with plain means that
// is half of what a uniform medium takes. What was gathered is multiplied by the opacity anew at every step, and values that the opacity has
// been multiplied into by it again. Environment and media, of which the listing says nothing, come in as in traceCone.
vec3 traceConeAsPublished(vec3 apex, vec3 direction, float ratio, uint cone) {
  float leastDiameter = 2.0 * voxelSize, distance = leastDiameter;
  float firstDiameter = max(leastDiameter, ratio * distance);
  if (jitter > 0.0) distance += jitter * shiftOf(cone) * (0.5 * firstDiameter);
  float end = min(maxDistance, insideGrid(apex, direction).y);
  vec3 radiance = vec3(0.0);
  float opacity = 0.0;
  while (distance <= end && opacity < 1.0) {
    float diameter = max(leastDiameter, ratio * distance);
    vec3 texcoord = (apex + direction * distance - gridLow) / gridExtent;
    vec4 value = textureLod(radianceGrid, texcoord, log2(diameter / voxelSize));
#if MEDIUM != MEDIUM_NONE
    value.rgb *= exp(-opticalDepth(apex, direction, distance, kMediumSteps));
#endif
    float stepOpacity = stepOpacityOf(max(1.0 - value.a, 0.0), (diameter / 2.0) / firstDiameter);
    radiance = radiance * opacity + (1.0 - opacity) * (stepOpacity * value.rgb);
    opacity += stepOpacity * (1.0 - opacity);
    distance += diameter / 2.0;
  }
  radiance *= unit;
#if ENVIRONMENT
  vec3 passed = vec3(max(1.0 - opacity, 0.0));
#if MEDIUM != MEDIUM_NONE
  passed *= exp(-opticalDepth(apex, direction, kNoReach, kMediumSteps));
#endif
  radiance += passed * environment;
#endif
  return radiance;
}

#if DIFFUSE
// Mean of the arriving radiance over the hemisphere, weighted by the cosine; the weights sum to 1, but not those as published.
vec3 gatherDiffuse(vec3 apex, vec3 normal) {
  vec3 tangent = tangentTo(normal), bitangent = cross(normal, tangent);
  // Listing 4.12: one cone along the normal and four at 45 degrees, weighted by the cosine.
  if (asPublished != 0) {
    const float kPrintedWeight = 0.707;
    vec3 sum = traceConeAsPublished(apex, normal, coneRatio, 0u);
    for (int i = 0; i < 4; ++i) {
      vec3 side = (i & 1) == 0 ? tangent : bitangent;
      vec3 direction = normalize(normal + (i < 2 ? side : -side));
      sum += kPrintedWeight * traceConeAsPublished(apex, direction, coneRatio, uint(i + 1));
    }
    return sum;
  }
  if (publishedCones != 0) {
    // Deviates: divided by the sum of the weights, 1 + 4 / sqrt 2, so that a constant environment keeps its radiance.
    const float kTilted = 0.70710678118654752440;
    float tanHalfAngle = 0.5 * coneRatio;
    vec3 sum = traceCone(apex, normal, tanHalfAngle, 1.0, 0u);
    for (int i = 0; i < 4; ++i) {
      vec3 side = (i & 1) == 0 ? tangent : bitangent;
      sum += kTilted * traceCone(apex, normalize(normal + (i < 2 ? side : -side)), tanHalfAngle, kTilted, uint(i + 1));
    }
    return sum / (1.0 + 4.0 * kTilted);
  }
  vec3 sum = vec3(0.0);
  for (int i = 0; i < coneCount; ++i) {
    float cosTheta, tanHalfAngle;
    vec3 direction = cosineCone(i, coneCount, tangent, bitangent, normal, cosTheta, tanHalfAngle);
    sum += traceCone(apex, direction, tanHalfAngle, cosTheta, uint(i));
  }
  return sum / float(coneCount);
}
#endif

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, textureSize(gPosition, 0)))) return;
  vec4 position = texelFetch(gPosition, pixel, 0);
  vec3 diffuse = vec3(0.0), glossy = vec3(0.0);
  if (position.w > 0.0) {
    vec3 normal = texelFetch(gNormal, pixel, 0).xyz;
    vec3 apex = position.xyz;
    if (asPublished == 0) apex += texelFetch(gGeometricNormal, pixel, 0).xyz * (offset * voxelSize);
#if DIFFUSE
    vec3 albedo = texelFetch(gDiffuse, pixel, 0).rgb;
    if (any(greaterThan(albedo, vec3(0.0)))) diffuse = albedo * gatherDiffuse(apex, normal);
#endif
#if GLOSSY
    vec4 specular = texelFetch(gSpecular, pixel, 0);
    if (any(greaterThan(specular.rgb, vec3(0.0)))) {
      vec3 mirror = reflect(normalize(position.xyz - eyeWorld), normal);
      // The integral of the lobe with the cosine of the surface is specular times the cosine of the mirror direction.
      float tanHalfAngle = tanOfHalfAngle(cosHalfAngleOfLobe(specular.w));
      const uint kGlossyCone = 0xffffu;
      float cosMirror = max(dot(mirror, normal), 0.0);
      vec3 arriving = asPublished != 0 ? traceConeAsPublished(apex, mirror, 2.0 * tanHalfAngle, kGlossyCone)
                                       : traceCone(apex, mirror, tanHalfAngle, cosMirror, kGlossyCone);
      glossy = specular.rgb * cosMirror * arriving;
    }
#endif
  }
#if DIFFUSE
  imageStore(diffuseImage, pixel, vec4(diffuse, 1.0));
#endif
#if GLOSSY
  imageStore(glossyImage, pixel, vec4(glossy, 1.0));
#endif
}
