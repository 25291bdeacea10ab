#version 450
// A coarser level of the node map: the lowest common ancestor of the nodes of 2 x 2 texels, and of the third row or column at an odd end.
layout(local_size_x = 64) in;
#include "octree_photons.glsl"

layout(std140, binding = 0) uniform Coarser {
  ivec3 mapSize;  // texels of the level that is written, layers
  ivec2 fine;     // of the level that is read
  int fineLevel;
};
layout(binding = 0) uniform usampler2DArray nodes;
layout(binding = 0, r32ui) uniform writeonly uimage2DArray nodeMap;  // the same

void main() {
  uint index = listIndex();
  if (index >= uint(mapSize.x * mapSize.y * mapSize.z)) return;
  ivec3 texel = ivec3(int(index) % mapSize.x, int(index) / mapSize.x % mapSize.y, int(index) / (mapSize.x * mapSize.y));
  ivec2 last = mix(2 * texel.xy + 1, fine - 1, equal(texel.xy, mapSize.xy - 1));
  uint code = 0u;
  for (int y = 2 * texel.y; y <= min(last.y, fine.y - 1); ++y)
    for (int x = 2 * texel.x; x <= min(last.x, fine.x - 1); ++x) code = commonAncestor(code, texelFetch(nodes, ivec3(x, y, texel.z), fineLevel).r);
  imageStore(nodeMap, texel, uvec4(code));
}
