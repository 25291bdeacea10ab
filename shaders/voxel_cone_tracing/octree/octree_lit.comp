#version 450
// Marks the bricks of all depths that photons change. Each texel of the node map marks the nodes on the path from the node of its parent
// texel down to its own node, so that the path that several photons share is followed once (Crassin et al. 2011, Sec. 6).
layout(local_size_x = 64) in;
#include "octree_photons.glsl"

layout(std140, binding = 0) uniform NodeMapLevel {
  ivec3 mapSize;  // texels, layers
  int level;
  ivec2 coarser;  // texels of the next coarser level; 0: no such level
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
    if (brick != kNone) lit[brick] = 1u;  // all invocations write the same value
  }
}
