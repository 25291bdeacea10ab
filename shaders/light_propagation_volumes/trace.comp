#version 450
// Glossy light: one cone per pixel through the reflection grid (thesis 004 Sec. 4.3.5). The march is that of Listing 4.13 as printed.
// Samples are at least two voxels wide, and are taken at the beginning of a step of half their width. The opacity's exponent is half the
// diameter over the first diameter. Each step multiplies the gathered radiance by the opacity again. Listing 4.37 fades samples by their
// distance, and the result by the surface's distance to the eye.
#include "common/cones.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

const int kFadeNone = 0, kFadeFalls = 1, kFadeGrows = 2;
layout(constant_id = 0) const int fade = kFadeFalls;

layout(std140, binding = 0) uniform Parameters {
  vec3 gridLow;        // m
  float voxelSize;     // m
  vec3 gridExtent;     // m
  float reach;         // length of a cone, m
  vec3 eyeWorld;
  float fadeDistance;  // distance from the eye at which reflections have faded out, m
  float unit;          // radiance of the value 1 of the grid, W/(sr m^2)
};
layout(binding = 0) uniform sampler2D gPosition;
layout(binding = 1) uniform sampler2D gNormal;
layout(binding = 2) uniform sampler2D gSpecular;
layout(binding = 3) uniform sampler3D radianceGrid;
layout(binding = 0, rgba32f) uniform writeonly image2D glossyImage;

// Deviates with kFadeFalls: the print lets the factor grow with the distance, so that near samples count least.
float fadeAt(float distance) {
  float share = clamp(distance / reach, 0.0, 1.0);
  return fade == kFadeGrows ? share : fade == kFadeFalls ? 1.0 - share : 1.0;
}

vec3 traceCone(vec3 apex, vec3 direction, float ratio) {
  float leastDiameter = 2.0 * voxelSize, distance = leastDiameter;
  float firstDiameter = max(leastDiameter, ratio * distance);
  vec3 radiance = vec3(0.0);
  float opacity = 0.0;
  while (distance <= reach && opacity < 1.0) {
    float diameter = max(leastDiameter, ratio * distance);
    vec4 value = textureLod(radianceGrid, (apex + direction * distance - gridLow) / gridExtent, log2(diameter / voxelSize)) * fadeAt(distance);
    float stepOpacity = stepOpacityOf(max(1.0 - value.a, 0.0), 0.5 * diameter / firstDiameter);
    radiance = radiance * opacity + (1.0 - opacity) * stepOpacity * value.rgb;
    opacity += (1.0 - opacity) * stepOpacity;
    distance += 0.5 * diameter;
  }
  return radiance * unit;
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, textureSize(gPosition, 0)))) return;
  vec4 position = texelFetch(gPosition, pixel, 0);
  vec3 glossy = vec3(0.0);
  if (position.w > 0.0) {
    vec4 specular = texelFetch(gSpecular, pixel, 0);
    if (any(greaterThan(specular.rgb, vec3(0.0)))) {
      vec3 normal = texelFetch(gNormal, pixel, 0).xyz;
      vec3 mirror = reflect(normalize(position.xyz - eyeWorld), normal);
      // The print leaves the diameter of a cone over its height to the user. Here the cone has the solid angle of the lobe, 2 pi / (n + 1).
      float ratio = 2.0 * tanOfHalfAngle(cosHalfAngleOfLobe(specular.w));
      float atSurface = fade == kFadeNone ? 1.0 : 1.0 - clamp(distance(position.xyz, eyeWorld) / fadeDistance, 0.0, 1.0);
      glossy = specular.rgb * (max(dot(mirror, normal), 0.0) * atSurface) * traceCone(position.xyz, mirror, ratio);
    }
  }
  imageStore(glossyImage, pixel, vec4(glossy, 1.0));
}
