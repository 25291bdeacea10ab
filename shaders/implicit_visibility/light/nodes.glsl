// The nodes of the hierarchy of surface elements, by number. Ports SurfaceElements and ElementLight.
#ifndef LUMIVOX_NODES
#define LUMIVOX_NODES
#include "texels.glsl"

layout(std140, binding = 0) uniform Nodes {
  int leafCount, firstGroup;  // leaves are the nodes from 0 on, groups from firstGroup on
  int binCount;               // number of bins
};

layout(binding = 0) uniform sampler2D elementPosition;  // xyz m; w area, m^2
layout(binding = 1) uniform sampler2D elementNormal;    // xyz normal, shorter than 1 if curved; groups: area projected along axes, m^2

// First texel of a node's radiance.
uint radianceTexel(uint node) {
  uint first = uint(firstGroup);
  return node < first ? 2u * node : 2u * first + 6u * (node - first);
}
#endif
