#version 450
// Exchanges the nine voxels that a brick and its higher neighbour along one axis share. kAdd adds the left brick's values to the right, and
// kCopy then copies the sums back to the left: this completes sums of which each brick holds a part (Crassin et al. 2011, Sec. 6; thesis
// 004, Sec. 3.1.3, Fig. 34). kAverage completes means of which each brick holds one (Sec. 4.2.2). One invocation handles each pair of
// voxels, so that none writes what another reads. Run along x, then y, then z, so that the corners that eight bricks share agree too.
layout(local_size_x = 64) in;
#include "octree_levels.glsl"

const int kAdd = 0, kCopy = 1, kAverage = 2;
layout(constant_id = 0) const int way = kCopy;

layout(std140, binding = 0) uniform Borders {
  int depth;
  int axis;
};
layout(binding = 0) uniform sampler3D pool;
layout(binding = 0) uniform writeonly image3D poolImage;  // the same

void transfer(ivec3 left, ivec3 right) {
  if (way == kCopy) {
    imageStore(poolImage, left, texelFetch(pool, right, 0));
    return;
  }
  vec4 sum = texelFetch(pool, left, 0) + texelFetch(pool, right, 0);
  if (way == kAverage) {
    sum *= 0.5;
    imageStore(poolImage, left, sum);
  }
  imageStore(poolImage, right, sum);
}

void main() {
  uint brick, lane;
  if (!itemOf(depth, 9u, brick, lane)) return;
  OctreeNode node = octreeNodes[octreeBricks[brick].node];
  uint neighbour = axis == 0 ? node.neighbourX : axis == 1 ? node.neighbourY : node.neighbourZ;
  if (neighbour == kNone) return;
  ivec3 low;
  low[axis] = 0;
  low[(axis + 1) % 3] = int(lane % 3u);
  low[(axis + 2) % 3] = int(lane / 3u);
  ivec3 high = low;
  high[axis] = 2;
  transfer(texelOf(brick) + high, texelOf(octreeNodes[neighbour].brick) + low);
}
