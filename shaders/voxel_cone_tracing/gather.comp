#version 450
// Crassin et al. 2011, Sec. 7: final gathering with a few wide cones, and one narrow cone for glossy light.
// Thesis 004, Sec. 4.2.1, Listings 4.11 to 4.13.
#pragma lumivox axis DIFFUSE 0 1
#pragma lumivox axis GLOSSY 0 1
#pragma lumivox require DIFFUSE || GLOSSY
#include "march.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 0) const int coneCount = 6;
layout(constant_id = 1) const int publishedCones = 0;
layout(constant_id = 2) const int asPublished = 0;

layout(std140, binding = 0) uniform Parameters {
  vec3 eyeWorld;
  float coneRatio;  // diameter of one of the five cones over its height
};
layout(binding = 0) uniform sampler2D gPosition;
layout(binding = 1) uniform sampler2D gNormal;
layout(binding = 2) uniform sampler2D gGeometricNormal;
#if DIFFUSE
layout(binding = 3) uniform sampler2D gDiffuse;
layout(binding = 0, rgba32f) uniform writeonly image2D diffuseImage;
#endif
#if GLOSSY
layout(binding = 5) uniform sampler2D gSpecular;
layout(binding = 1, rgba32f) uniform writeonly image2D glossyImage;
#endif

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
    if (asPublished == 0) apex += texelFetch(gGeometricNormal, pixel, 0).xyz * (offset * finestVoxel(apex));
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
