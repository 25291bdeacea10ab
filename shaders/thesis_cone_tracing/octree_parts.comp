#version 450
// Pre-filters bricks in parts, from the children of each node only. The centre of a brick is then complete; its faces, edges and corners
// still lack the parts of the neighbours (Sec. 3.1.3, 4.2.2, Fig. 70 and 71; Crassin et al. 2011, Sec. 5). A fine voxel has in each brick
// that holds it a weight of one over the number of these bricks, so that all parts together have the 3 x 3 x 3 weights 1, 2, 1 over 4.
// Parts to be added (Crassin) are shares of the sum; parts to be averaged (thesis) are means.
layout(local_size_x = 64) in;
#include "octree_levels.glsl"

// How many coordinates of the filtered voxels lie on the border of the brick: 0 centre, 1 faces, 2 edges, 3 corners.
layout(constant_id = 0) const int part = 0;

layout(std140, binding = 0) uniform Parts {
  int depth;
  int means;  // 1: each part is a mean; 0: a share of the sum
};
layout(binding = 0) uniform sampler3D pool;
layout(binding = 0) uniform writeonly image3D poolImage;  // the same

const uint kPartThreads[4] = uint[4](1u, 6u, 12u, 8u);

// The voxel of a brick that an invocation filters.
ivec3 vertexOf(uint lane) {
  ivec3 vertex = ivec3(1);
  if (part == 3) return 2 * ivec3(lane & 1u, lane >> 1 & 1u, lane >> 2);
  if (part == 1) vertex[lane >> 1] = 2 * int(lane & 1u);
  if (part == 2) {
    uint along = lane >> 2;
    vertex[(along + 1u) % 3u] = 2 * int(lane & 1u);
    vertex[(along + 2u) % 3u] = 2 * int(lane >> 1 & 1u);
  }
  return vertex;
}

void main() {
  uint brick, lane;
  if (!itemOf(depth, kPartThreads[part], brick, lane)) return;
  uint tile = octreeNodes[octreeBricks[brick].node].children;
  ivec3 place = unpackVoxel(octreeBricks[brick].place);
  ivec3 vertex = vertexOf(lane), low = max(2 * vertex - 1, 0), high = min(2 * vertex + 1, 4);
  vec4 sum = vec4(0.0);
  for (int i = 0; i < 8 && tile != kNone; ++i) {
    uint childBrick = octreeNodes[tile + uint(i)].brick;
    if (childBrick == kNone) continue;
    ivec3 origin = 2 * ivec3(i & 1, i >> 1 & 1, i >> 2), from = max(low, origin), to = min(high, origin + 2);
    for (int z = from.z; z <= to.z; ++z)
      for (int y = from.y; y <= to.y; ++y)
        for (int x = from.x; x <= to.x; ++x) {
          vec4 value = texelFetch(pool, texelOf(childBrick) + ivec3(x, y, z) - origin, 0);
          // On the border of the grid there is no neighbour to add the other half.
          ivec3 fine = 4 * place + ivec3(x, y, z);
          ivec3 outer = ivec3(equal(fine, ivec3(0))) + ivec3(equal(fine, ivec3(4 << depth)));
          sum += means != 0 ? value : value * float(1 << outer.x + outer.y + outer.z);
        }
  }
  // Each counted value has a weight of 1/4 along each axis: the two outer voxels, and the middle voxel in each of the two nodes or children
  // that hold it.
  sum /= 64.0;
  // Along each axis across a border, the part has half of the weight.
  if (means != 0) sum *= exp2(float(part));
  imageStore(poolImage, texelOf(brick) + vertex, sum);
}
