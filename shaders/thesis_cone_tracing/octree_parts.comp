#version 450
// Pre-filtering in parts: from the children of each node alone, the centre of its brick, which they know all of, then its faces, edges and
// corners, of which the neighbours know the rest (Sec. 3.1.3, 4.2.2, Fig. 70 and 71; Crassin et al. 2011, Sec. 5).
// A fine voxel counts in each brick that holds it by the inverse of their number, so that all parts together have the 3 x 3 x 3 weights 1, 2, 1
// over 4. To be added (Crassin) a part is its share of the sum; to be averaged (thesis) it is a mean of its own.
layout(local_size_x = 64) in;
#include "octree_levels.glsl"

// Coordinates of a voxel of a brick that lie on its border.
layout(constant_id = 0) const int part = 0;

layout(std140, binding = 0) uniform Parts {
  int depth;
  int means;  // 1: each part is a mean; 0: a share of the sum
};
layout(binding = 0) uniform sampler3D pool;
layout(binding = 0) uniform writeonly image3D poolImage;  // the same

const uint kPartThreads[4] = uint[4](1u, 6u, 12u, 8u);

// The voxel of a brick that a thread makes.
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
          // On the border of the grid there is no other node to add the other half.
          ivec3 fine = 4 * place + ivec3(x, y, z);
          ivec3 outer = ivec3(equal(fine, ivec3(0))) + ivec3(equal(fine, ivec3(4 << depth)));
          sum += means != 0 ? value : value * float(1 << outer.x + outer.y + outer.z);
        }
  }
  // The weight of every one that is counted is a quarter along each axis: that of the outer two, and of the middle one in each of the two
  // nodes or children that hold it.
  sum /= 64.0;
  // Of a border there is half the weight along each axis across it.
  if (means != 0) sum *= exp2(float(part));
  imageStore(poolImage, texelOf(brick) + vertex, sum);
}
