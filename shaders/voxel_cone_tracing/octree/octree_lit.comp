#version 450
// Marks the bricks that photons change, of all depths. Each texel of the node map takes the nodes on the way down from its parent's: so the
// way that photons share is taken once for all of them (Crassin et al. 2011, Sec. 6).
layout(local_size_x = 64) in;
#include "octree_photons.glsl"

layout(std140, binding = 0) uniform NodeMapLevel {
  ivec3 mapSize;  // texels, layers
  int level;
  ivec2 coarser;  // texels of the next level; 0: there is none
};
layout(binding = 0) uniform usampler2DArray nodes;
layout(std430, binding = 4) writeonly buffer Lit { uint lit[]; };  // by brick

void main() {
  uint index = listIndex();
  if (index >= uint(mapSize.x * mapSize.y * mapSize.z)) return;
  ivec3 texel = ivec3(int(index) % mapSize.x, int(index) / mapSize.x % mapSize.y, int(index) / (mapSize.x * mapSize.y));
  uint code = texelFetch(nodes, texel, level).r;
  if (code == 0u) return;
  int first = 0;
  if (coarser.x > 0) first = depthOf(texelFetch(nodes, ivec3(min(texel.xy >> 1, coarser - 1), texel.z), level + 1).r) + 1;
  for (int depth = first; depth <= min(depthOf(code), octreeDepth); ++depth) {
    uint brick = brickOfCode(ancestorOf(code, depth));
    if (brick != kNone) lit[brick] = 1u;  // whoever writes here writes the same
  }
}
