// Reflection by the Phong lobe from the bins of a leaf: Dong et al. 2007, Eq. 2, with the lobe constant within a bin.
#ifndef LUMIVOX_LOBE
#define LUMIVOX_LOBE
#include "../links/links.glsl"
#include "sent.glsl"
#include "common/brdf.glsl"
#if ENVIRONMENT
#include "environment_of_bin.glsl"
#endif

layout(std140, binding = 3) uniform Lobe {
  vec3 environment;  // W/(sr m^2)
  vec3 eyeWorld;
};

vec3 lobeWeight(uint bin, vec3 normal, float scale, vec3 toEye, vec4 specular) {
  float weight = binWeight(bin, normal, scale);
  return weight > 0.0 ? weight * phongLobe(specular.rgb, specular.w, normal, toEye, directions[bin].xyz) : vec3(0.0);
}

// Radiance towards the eye, W/(sr m^2). `normal` faces the eye.
vec3 glossyRadiance(uint leaf, vec3 normal, vec3 toEye, vec4 specular) {
  uvec4 entry = first[leaf];
  float scale = uintBitsToFloat(entry.z);
  vec3 position = texelFetch(elementPosition, texelOf(leaf), 0).xyz, sum = vec3(0.0);
#if ENVIRONMENT
  uint expected = 0u;
#endif
  for (uint i = 0u; i < entry.y; ++i) {
    uvec2 link = links[entry.x + i];
    uint bin = linkBin(link);
#if ENVIRONMENT
    for (; expected < bin; ++expected) sum += environmentOfBin(environment, expected) * lobeWeight(expected, normal, scale, toEye, specular);
    expected = bin + 1u;
#endif
    vec3 weight = lobeWeight(bin, normal, scale, toEye, specular);
    if (all(lessThanEqual(weight, vec3(0.0)))) continue;
    sum += weight * sentOver(link, position);
  }
#if ENVIRONMENT
  for (; expected < uint(binCount); ++expected)
    sum += environmentOfBin(environment, expected) * lobeWeight(expected, normal, scale, toEye, specular);
#endif
  return sum;
}
#endif
