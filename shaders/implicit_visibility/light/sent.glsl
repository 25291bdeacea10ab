// Radiance over a link: from a texture as ElementLight::radiance and, with OUTGOING, from the directional radiance of glossy elements.
#ifndef LUMIVOX_SENT
#define LUMIVOX_SENT
#include "../links/links.glsl"
#include "nodes.glsl"
#if OUTGOING
#include "outgoing.glsl"
#endif

layout(binding = 2) uniform sampler2D sentRadiance;

// Radiance of a group: the mean of the three axis values on the direction's side, weighted by the squared components, which sum to 1.
vec3 sentByGroup(uint node, vec3 direction) {
  uint texel = radianceTexel(node);
  vec3 sum = vec3(0.0);
  for (uint axis = 0u; axis < 3u; ++axis) {
    float along = direction[axis];
    sum += along * along * texelFetch(sentRadiance, texelOf(texel + 2u * axis + (along < 0.0 ? 1u : 0u)), 0).rgb;
  }
  return sum;
}

// Radiance over a link at `position`, W/(sr m^2). For a disc, the link stores which side is seen.
vec3 sentOver(uvec2 link, vec3 position) {
  uint node = link.y;
  vec3 sent;
  if (node < uint(firstGroup)) sent = texelFetch(sentRadiance, texelOf(2u * node + linkSide(link)), 0).rgb;
  else sent = sentByGroup(node, normalize(position - texelFetch(elementPosition, texelOf(node), 0).xyz));
#if OUTGOING
  // Opposite to the centre of the bin. The direction to the node's centre would be the same for all bins that see the node.
  uint row = outgoingRows[node];
  if (row != kNoRow) sent += outgoingTowards(row, node, -directions[linkBin(link)].xyz);
#endif
  return sent;
}
#endif
