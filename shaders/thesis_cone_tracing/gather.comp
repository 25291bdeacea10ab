#version 450
// Final gathering (Sec. 4.2.1, Listings 4.11 to 4.13): five cones over the hemisphere, with the weights 1 and 0.707. They are not
// normalised, so that a constant environment counts 3.828 times. One more cone, as wide as the Phong lobe, lies around the mirror
// direction. Its width, and the multiplication of its light by the cosine at the surface, are not printed.
#pragma lumivox axis DIFFUSE 0 1
#pragma lumivox axis GLOSSY 0 1
#pragma lumivox require DIFFUSE || GLOSSY
#pragma lumivox axis ENVIRONMENT 0 1
#include "common/random.glsl"
#if ENVIRONMENT
#include "common/environment.glsl"
#endif
#include "store.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(std140, binding = 0) uniform Cones {
  vec3 eyeWorld;
  float coneRatio;    // diameter of one of the five cones over its height
  vec3 environment;   // radiance of the environment
  float maxDistance;  // m
  float jitter;       // largest shift of a cone's first sample, in steps
  uvec2 seed;
};
layout(binding = 0) uniform sampler2D gPosition;
layout(binding = 1) uniform sampler2D gNormal;
#if DIFFUSE
layout(binding = 3) uniform sampler2D gDiffuse;
layout(binding = 0, rgba32f) uniform writeonly image2D diffuseImage;
#endif
#if GLOSSY
layout(binding = 5) uniform sampler2D gSpecular;
layout(binding = 1, rgba32f) uniform writeonly image2D glossyImage;
#endif

// Random shift of a cone's first sample, [0, 1): depends on the pixel, the cone and the seed.
float shiftOf(uint cone) {
  return unitInterval(hash4(uvec4(gl_GlobalInvocationID.x | gl_GlobalInvocationID.y << 16, cone, seed)).xy).x;
}

// Listing 4.13, with lengths in metres instead of shares of the grid. A sample is at least two finest voxels wide, otherwise as wide as the
// cone, and is taken at the beginning of its step. The exponent of the opacity correction is half of the sample's diameter over that of the
// first sample: with plain means, this is half of the exponent of a uniform medium. As printed, each step multiplies the gathered radiance
// by the opacity again, and multiplies values that are pre-multiplied by opacity once more. The environment, which the listing does not
// mention, is weighted by one minus the opacity.
vec3 traceCone(vec3 apex, vec3 direction, float ratio, uint cone) {
  float leastDiameter = 2.0 * storeVoxel, distance = leastDiameter;
  float firstDiameter = max(leastDiameter, ratio * distance);
  if (jitter > 0.0) distance += jitter * shiftOf(cone) * (0.5 * firstDiameter);
  float end = min(maxDistance, insideVolume(storeLow, storeExtent, apex, direction).y);
  vec3 radiance = vec3(0.0);
  float opacity = 0.0;
  while (distance <= end && opacity < 1.0) {
    float diameter = max(leastDiameter, ratio * distance);
    vec4 value = readStore(apex + direction * distance, direction, diameter);
    float stepOpacity = stepOpacityOf(max(1.0 - value.a, 0.0), (diameter / 2.0) / firstDiameter);
    radiance = radiance * opacity + (1.0 - opacity) * (stepOpacity * value.rgb);
    opacity += stepOpacity * (1.0 - opacity);
    distance += diameter / 2.0;
  }
  radiance *= storeUnit;
#if ENVIRONMENT
  radiance += max(1.0 - opacity, 0.0) * environmentAlong(environment, direction, 0.5 * ratio);
#endif
  return radiance;
}

const int kCones = 5;             // Listing 4.12
const uint kGlossyCone = 0xffffu;  // number of the glossy cone

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, textureSize(gPosition, 0)))) return;
  vec4 position = texelFetch(gPosition, pixel, 0);
  vec3 diffuse = vec3(0.0), glossy = vec3(0.0);
  if (position.w > 0.0) {
    vec3 normal = texelFetch(gNormal, pixel, 0).xyz;
    int first = 0, end = kCones;  // range of cones: five diffuse cones, then one glossy cone
#if DIFFUSE
    vec3 albedo = texelFetch(gDiffuse, pixel, 0).rgb, tangent = tangentTo(normal), bitangent = cross(normal, tangent);
    if (!any(greaterThan(albedo, vec3(0.0)))) first = kCones;
#else
    first = kCones;
#endif
#if GLOSSY
    vec4 specular = texelFetch(gSpecular, pixel, 0);
    vec3 mirror = reflect(normalize(position.xyz - eyeWorld), normal);
    float cosMirror = max(dot(mirror, normal), 0.0);
    if (any(greaterThan(specular.rgb, vec3(0.0))) && cosMirror > 0.0) end = kCones + 1;
#endif
    // One call of the march for all cones: it is inlined at every call.
    for (int i = first; i < end; ++i) {
      vec3 direction = normal;
      float ratio = coneRatio, weight = 1.0;
      uint number = uint(i);
#if DIFFUSE
      if (i > 0 && i < kCones) {
        vec3 side = (i & 1) != 0 ? tangent : bitangent;
        direction = normalize(normal + (i <= 2 ? side : -side));
        weight = 0.707;
      }
#endif
#if GLOSSY
      if (i == kCones) {
        direction = mirror;
        ratio = 2.0 * tanOfHalfAngle(cosHalfAngleOfLobe(specular.w));
        weight = cosMirror;
        number = kGlossyCone;
      }
#endif
      vec3 arriving = weight * traceCone(position.xyz, direction, ratio, number);
      if (i < kCones)
        diffuse += arriving;
      else
        glossy += arriving;
    }
#if DIFFUSE
    diffuse *= albedo;
#endif
#if GLOSSY
    glossy *= specular.rgb;
#endif
  }
#if DIFFUSE
  imageStore(diffuseImage, pixel, vec4(diffuse, 1.0));
#endif
#if GLOSSY
  imageStore(glossyImage, pixel, vec4(glossy, 1.0));
#endif
}
