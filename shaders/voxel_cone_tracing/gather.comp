#version 450
// Crassin et al. 2011, Sec. 7: final gathering with a few wide cones, and one narrow cone for glossy light.
// Thesis 004, Sec. 4.2.1, Listings 4.11 to 4.13.
#pragma lumivox axis DIFFUSE 0 1
#pragma lumivox axis GLOSSY 0 1
#pragma lumivox require DIFFUSE || GLOSSY
// To which side the voxels of the dense grid shine.
#pragma lumivox axis LOBES 0 1
#pragma lumivox require !LOBES || STORE == dense
#include "march.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 0) const int coneCount = 6;
layout(constant_id = 1) const int publishedCones = 0;
layout(constant_id = 2) const int asPublished = 0;
layout(constant_id = 3) const int glossyCones = 1;

layout(std140, binding = 0) uniform Parameters {
  vec3 eyeWorld;
  float coneRatio;  // diameter of one of the five cones over its height
  int every;        // one pixel of so many along each axis is gathered
  int pattern;      // pixels in a square of this side have cones of their own
  int arrivingDiffuse; // 1: what arrives is written, for reconstruct.comp; 0: what is reflected
  int arrivingGlossy;  // the same
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
// Where in its stratum each cone of a pixel lies, along the square of the radius and around, both in turns: in the middle and at 0, or of
// a sequence that fills the pattern's squares evenly (R2: Roberts 2018).
vec2 placeInStratum() {
  if (pattern == 1) return vec2(0.5, 0.0);
  const vec2 kR2 = vec2(0.75487766624669276, 0.56984029099805327);
  uvec2 place = gl_GlobalInvocationID.xy % uint(pattern);
  return fract(0.5 + float(place.y * uint(pattern) + place.x) * kR2);
}

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
  vec2 place = placeInStratum();
  for (int i = 0; i < coneCount; ++i) {
    float cosTheta, tanHalfAngle;
    vec3 direction = cosineCone(i, coneCount, place, tangent, bitangent, normal, cosTheta, tanHalfAngle);
    sum += traceCone(apex, direction, tanHalfAngle, cosTheta, uint(i));
  }
  return sum / float(coneCount);
}
#endif

#if GLOSSY
// Mean over the Phong lobe cos^n around the mirror direction of the arriving radiance times the cosine of the surface: what the integral of
// the lobe and the cosine comes to, over the specular albedo. One cone is as wide as the lobe's solid angle; several have equal shares of
// the lobe, each as wide as its share, and those below the horizon bring nothing.
vec3 gatherGlossy(vec3 apex, vec3 normal, vec3 mirror, float exponent) {
  const uint kGlossyCone = 0xffffu;
  if (asPublished != 0 || glossyCones == 1) {
    float tanHalfAngle = tanOfHalfAngle(cosHalfAngleOfLobe(exponent)), cosMirror = max(dot(mirror, normal), 0.0);
    return cosMirror * (asPublished != 0 ? traceConeAsPublished(apex, mirror, 2.0 * tanHalfAngle, kGlossyCone)
                                         : traceCone(apex, mirror, tanHalfAngle, cosMirror, kGlossyCone));
  }
  vec3 tangent = tangentTo(mirror), bitangent = cross(mirror, tangent), sum = vec3(0.0);
  for (int i = 0; i < glossyCones; ++i) {
    float share = (float(i) + 0.5) / float(glossyCones), angle = float(i) * kGoldenAngle;
    float cosAxis = pow(1.0 - share, 1.0 / (exponent + 1.0)), sinAxis = sqrt(max(1.0 - cosAxis * cosAxis, 0.0));
    vec3 direction = mirror * cosAxis + (tangent * cos(angle) + bitangent * sin(angle)) * sinAxis;
    float cosTheta = dot(direction, normal);
    if (cosTheta <= 0.0) continue;
    // The density of the lobe there, (n + 1) / (2 pi) cos^n, times the solid angle 2 pi (1 - cos(half angle)) is the share.
    float cosHalfAngle = max(1.0 - 1.0 / (float(glossyCones) * (exponent + 1.0) * pow(cosAxis, exponent)), 0.5);
    sum += cosTheta * traceCone(apex, direction, tanOfHalfAngle(cosHalfAngle), cosTheta, kGlossyCone + uint(i));
  }
  return sum / float(glossyCones);
}
#endif

void main() {
  ivec2 gathered = ivec2(gl_GlobalInvocationID.xy), size = textureSize(gPosition, 0);
  if (any(greaterThanEqual(every * gathered, size))) return;
  ivec2 pixel = min(every * gathered + every / 2, size - 1);
  vec4 position = texelFetch(gPosition, pixel, 0);
  vec3 diffuse = vec3(0.0), glossy = vec3(0.0);
  bool mirrors = false;
  if (position.w > 0.0) {
    vec3 normal = texelFetch(gNormal, pixel, 0).xyz;
    vec3 apex = position.xyz;
    if (asPublished == 0) apex += texelFetch(gGeometricNormal, pixel, 0).xyz * (offset * finestVoxel(apex));
#if DIFFUSE
    vec3 albedo = texelFetch(gDiffuse, pixel, 0).rgb;
    if (arrivingDiffuse != 0) albedo = vec3(1.0);
    if (any(greaterThan(albedo, vec3(0.0)))) diffuse = albedo * gatherDiffuse(apex, normal);
#endif
#if GLOSSY
    vec4 specular = texelFetch(gSpecular, pixel, 0);
    mirrors = any(greaterThan(specular.rgb, vec3(0.0)));
    if (mirrors) {
      vec3 mirror = reflect(normalize(position.xyz - eyeWorld), normal);
      glossy = (arrivingGlossy != 0 ? vec3(1.0) : specular.rgb) * gatherGlossy(apex, normal, mirror, specular.w);
    }
#endif
  }
#if DIFFUSE
  imageStore(diffuseImage, gathered, vec4(diffuse, 1.0));
#endif
#if GLOSSY
  imageStore(glossyImage, gathered, vec4(glossy, arrivingGlossy != 0 && !mirrors ? 0.0 : 1.0));  // 0: no sample
#endif
}
