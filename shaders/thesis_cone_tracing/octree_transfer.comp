#version 450
// Between bricks and their neighbours along one axis, for the nine voxels that both hold. To add to the right what the left one has found, and
// then to copy it back to the left, completes sums of which each holds a part (Crassin et al. 2011, Sec. 6; thesis 004, Sec. 3.1.3, Fig. 34).
// To average completes means of which each holds one (Sec. 4.2.2). Each pair of bricks is one thread's, so that none writes what another
// reads. x, then y, then z: then the corners that eight bricks share agree too.
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
