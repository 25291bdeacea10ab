// What comes over a link: radiance out of a texture as ElementLight::radiance and, with OUTGOING, what glossy elements pass on.
#ifndef LUMIVOX_SENT
#define LUMIVOX_SENT
#include "../links/links.glsl"
#include "nodes.glsl"
#if OUTGOING
#include "outgoing.glsl"
#endif

layout(binding = 2) uniform sampler2D sentRadiance;

// Of groups the mean of the three axes that the direction has parts of, by their squares, which sum to 1.
vec3 sentByGroup(uint node, vec3 direction) {
  uint texel = radianceTexel(node);
  vec3 sum = vec3(0.0);
  for (uint axis = 0u; axis < 3u; ++axis) {
    float along = direction[axis];
    sum += along * along * texelFetch(sentRadiance, texelOf(texel + 2u * axis + (along < 0.0 ? 1u : 0u)), 0).rgb;
  }
  return sum;
}

// W/(sr m^2), at `position`. Of a disc it is that of the side that the link tells.
vec3 sentOver(uvec2 link, vec3 position) {
  uint node = link.y;
  vec3 sent;
  if (node < uint(firstGroup)) sent = texelFetch(sentRadiance, texelOf(2u * node + linkSide(link)), 0).rgb;
  else sent = sentByGroup(node, normalize(position - texelFetch(elementPosition, texelOf(node), 0).xyz));
#if OUTGOING
  // Against the middle ray of the bin: towards the middle of a node that several rays meet all of them would read one direction.
  uint row = outgoingRows[node];
  if (row != kNoRow) sent += outgoingTowards(row, node, -directions[linkBin(link)].xyz);
#endif
  return sent;
}
#endif
