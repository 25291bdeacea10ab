#version 450
// Openness of leaves: the share of a side's projected solid angle whose bins have no link nearer than a distance.
#include "../links/links.glsl"
#include "nodes.glsl"
#include "common/constants.glsl"

layout(local_size_x = 64) in;
#include "common/list.glsl"

layout(std140, binding = 1) uniform Openness {
  float within;  // m
};
layout(binding = 0, rgba32f) uniform writeonly image2D openImage;

void main() {
  uint leaf = listIndex();
  if (leaf >= uint(leafCount)) return;
  uvec4 entry = first[leaf];
  vec3 normal = texelFetch(elementNormal, texelOf(leaf), 0).xyz;
  float front = 0.0, back = 0.0;
  for (uint i = 0u; i < entry.y; ++i) {
    uvec2 link = links[entry.x + i];
    if (linkDistance(link) >= within) continue;
    float weight = binWeight(linkBin(link), normal, uintBitsToFloat(entry.z));
    if (weight > 0.0) front += weight;
    else back -= weight;
  }
  imageStore(openImage, texelOf(2u * leaf), vec4(vec3(max(1.0 - front / kPi, 0.0)), 1.0));
  imageStore(openImage, texelOf(2u * leaf + 1u), vec4(vec3(max(1.0 - back / kPi, 0.0)), 1.0));
}
