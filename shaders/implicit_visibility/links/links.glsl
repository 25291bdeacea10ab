// Links of leaves to the nodes that they see, by bin. Port ElementLinks.
#ifndef LUMIVOX_LINKS
#define LUMIVOX_LINKS

layout(std430, binding = 0) readonly buffer Directions { vec4 directions[]; };  // per bin: xyz centre; w solid angle, sr
layout(std430, binding = 1) readonly buffer First { uvec4 first[]; };           // per leaf: first link, number of links, scale
layout(std430, binding = 2) readonly buffer Links { uvec2 links[]; };           // bin, side and distance; node

uint linkBin(uvec2 link) { return link.x & 0x7fffu; }
uint linkSide(uvec2 link) { return link.x >> 15 & 1u; }                         // of a disc: 0 front, 1 back
float linkDistance(uvec2 link) { return uintBitsToFloat(link.x & 0xffff0000u); }  // m

// Projected solid angle of a bin, sr, with the sign of the bin's side of the plane. `scale` makes the sum over a side pi.
float binWeight(uint bin, vec3 normal, float scale) { return directions[bin].w * scale * dot(directions[bin].xyz, normal); }

// Index, within the links of a leaf, of the first link with a bin of at least `bin`.
uint linkFrom(uvec2 range, uint bin) {
  uint low = 0u, high = range.y;
  while (low < high) {
    uint middle = (low + high) / 2u;
    if (linkBin(links[range.x + middle]) < bin) low = middle + 1u;
    else high = middle;
  }
  return low;
}
#endif
