#version 450
// Sec. 3.2 step 2 (Eq. 11): scales the averaged light so that at the point the local model (Eq. 10) gives the reflected light of all
// lights. The division is unbounded. Without PUBLISHED there are two limits: `amplification` times the
// light, and the radiance of the brightest light.
#pragma lumivox axis LOBE diffuse glossy
#pragma lumivox axis PUBLISHED 0 1
layout(local_size_x = 64) in;
#include "common/list.glsl"
#include "surface_points.glsl"
#include "light.glsl"

layout(std140, binding = 0) uniform Parameters {
  vec3 eyeWorld;
  float amplification;  // largest factor on the light
};
layout(binding = 0) uniform sampler2D lights;      // of this lobe
layout(binding = 1) uniform sampler2D places;
layout(binding = 2) uniform sampler2D brightest;   // w: radiance of the brightest light that arrives
layout(std430, binding = 0) writeonly buffer Kept { float keptShares[]; };  // share of the light of Eq. 11 that the limits keep
layout(binding = 0, rgba32f) uniform writeonly image2D normalisedImage;

void main() {
  uint index = listIndex();
  if (index >= uint(pointCount)) return;
  ivec2 texel = pointTexel(index);
  vec4 light = texelFetch(lights, texel, 0);
  vec3 position = texelFetch(pointPosition, texel, 0).xyz, normal = texelFetch(pointNormal, texel, 0).xyz;
  vec3 path = texelFetch(places, texel, 0).xyz - position;
  float distanceSquared = dot(path, path), strongest = max(light.r, max(light.g, light.b));
  float local = 0.0, share = 1.0;
  if (strongest > 0.0 && distanceSquared > 0.0) {
    vec3 toLight = path * inversesqrt(distanceSquared);
#if LOBE == LOBE_DIFFUSE
    local = dot(normal, toLight);
#else
    if (dot(normal, toLight) > 0.0 && light.w > 0.0)
      local = lobeCosine(light.w - 1.0, dot(reflect(normalize(position - eyeWorld), normal), toLight));
#endif
  }
  vec3 normalised = vec3(0.0);
#if PUBLISHED
  // As printed, limited to the range of a float.
  if (local > 0.0) normalised = dividedAsPublished(light.rgb * distanceSquared, local);
#else
  if (local > 0.0) {
    float most = min(amplification, texelFetch(brightest, texel, 0).w / strongest), asked = 1.0 / local;
    share = min(1.0, most / asked);
    normalised = light.rgb * min(asked, most);
  } else if (strongest > 0.0) {
    share = 0.0;
  }
#endif
  imageStore(normalisedImage, texel, vec4(normalised, light.w));
  keptShares[index] = share;
}
