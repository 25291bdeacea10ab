// Directional radiance that nodes with a glossy leaf reflect by their Phong lobes. Port ElementLight.
#ifndef LUMIVOX_OUTGOING
#define LUMIVOX_OUTGOING
#include "nodes.glsl"
#include "../links/direction_bins.glsl"

const uint kNoRow = 0xffffffffu;
layout(std140, binding = 4) uniform Outgoing {
  int outgoingSide;    // bins along a side of a face of the cube
  float tangentAbove;  // tangent of the smallest elevation at which a direction above a plane has a bin whose centre is above it too
};
layout(std430, binding = 5) readonly buffer OutgoingRows { uint outgoingRows[]; };  // of nodes
layout(binding = 8) uniform sampler2D outgoingRadiance;

// Radiance in a direction, W/(sr m^2); `direction` leads away from the node and has unit length. A bin across a leaf's plane holds the
// radiance of the side of its centre: for a direction near the plane, the next bin above the plane is read.
vec3 outgoingTowards(uint row, uint node, vec3 direction) {
  if (node < uint(firstGroup)) {
    vec3 normal = texelFetch(elementNormal, texelOf(node), 0).xyz;
    float cosine = dot(normal, direction);
    if (abs(cosine) < tangentAbove) direction += (cosine < 0.0 ? -tangentAbove - cosine : tangentAbove - cosine) * normal;
  }
  uint bin = directionBin(direction, outgoingSide, true);
  return texelFetch(outgoingRadiance, texelOf(row * uint(6 * outgoingSide * outgoingSide) + bin), 0).rgb;
}
#endif
