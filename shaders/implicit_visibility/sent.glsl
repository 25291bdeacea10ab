// Radiance that a node sends towards a point, out of a texture as ElementLight::radiance.
#ifndef LUMIVOX_SENT
#define LUMIVOX_SENT
#include "nodes.glsl"

layout(binding = 2) uniform sampler2D sentRadiance;

// W/(sr m^2); `direction` leads away from the node and has unit length. Of discs it is that of the side that is seen; of groups the mean of
// the three axes that the direction has parts of, by their squares, which sum to 1.
vec3 sentTowards(uint node, vec3 direction) {
  uint texel = radianceTexel(node);
  if (node < uint(firstGroup)) {
    bool isFront = dot(texelFetch(elementNormal, texelOf(node), 0).xyz, direction) >= 0.0;
    return texelFetch(sentRadiance, texelOf(texel + (isFront ? 0u : 1u)), 0).rgb;
  }
  vec3 sum = vec3(0.0);
  for (uint axis = 0u; axis < 3u; ++axis) {
    float along = direction[axis];
    sum += along * along * texelFetch(sentRadiance, texelOf(texel + 2u * axis + (along < 0.0 ? 1u : 0u)), 0).rgb;
  }
  return sum;
}
#endif
