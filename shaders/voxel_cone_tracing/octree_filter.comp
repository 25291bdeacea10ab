#version 450
// Pre-filtering of one level of an octree from the next finer one, whole voxels at once. Coarse voxel j covers the fine voxels 2j - 1 to 2j + 1
// along each axis, of the outer two a half: their weights are 1, 2, 1 over 4 (Crassin et al. 2011, Sec. 5; thesis 004, Sec. 3.1.2, Fig. 29).
// Each brick gets the eight voxels that are its own, with what lies in the neighbours below; the others are copied (octree_transfer.comp).
//
// `average` is the published mean. `facing` sees the fine voxels one behind the other along each axis, and takes the opacity of the axis that
// is most closed, as filter.comp does.
layout(local_size_x = 64) in;
#include "common/cones.glsl"
#include "children.glsl"
#include "octree_levels.glsl"

const int kFacing = 0, kAverage = 1;
layout(constant_id = 0) const int rule = kFacing;

layout(std140, binding = 0) uniform Coarse { int depth; };
layout(binding = 0) uniform sampler3D pool;
layout(binding = 0) uniform writeonly image3D poolImage;  // the same

uint children[8];  // bricks of this thread's node

// A fine voxel from the brick whose own it is. `place` is that of the node.
vec4 fineVoxel(ivec3 voxel, ivec3 place) {
  if (any(lessThan(voxel, ivec3(0)))) return vec4(0.0);
  ivec3 owner = voxel >> 1, child = owner - 2 * place;
  uint brick = all(greaterThanEqual(child, ivec3(0))) && all(lessThan(child, ivec3(2)))
                   ? children[child.x | child.y << 1 | child.z << 2]
                   : brickAt(owner, depth + 1);
  return brick == kNone ? vec4(0.0) : texelFetch(pool, texelOf(brick) + (voxel & 1), 0);
}

// The middle of three voxels and the nearer halves of the others, from one end and from the other.
vec4 throughThree(vec4 a, vec4 b, vec4 c) {
  vec4 first = slab(a, 0.5), last = slab(c, 0.5);
  return over(first, over(b, last)) + over(last, over(b, first));
}

// One value from those of the three axes.
vec4 facing(vec4 x, vec4 y, vec4 z) {
  float largest = max(x.a, max(y.a, z.a));
  if (largest <= 0.0) return vec4(0.0);
  vec3 weight = vec3(x.a, y.a, z.a) / largest;
  weight *= weight;
  vec4 sum = weight.x * x + weight.y * y + weight.z * z;
  return sum * (largest / sum.a);
}

void main() {
  uint brick, lane;
  if (!itemOf(depth, 8u, brick, lane)) return;
  ivec3 place = unpackVoxel(octreeBricks[brick].place), own = ivec3(lane & 1u, lane >> 1 & 1u, lane >> 2);
  uint tile = octreeNodes[octreeBricks[brick].node].children;
  for (uint child = 0u; child < 8u; ++child) children[child] = tile == kNone ? kNone : octreeNodes[tile + child].brick;
  ivec3 middle = 2 * (2 * place + own);
  vec4 fine[27];
  float most = 0.0;
  for (int i = 0; i < 27; ++i) {
    fine[i] = fineVoxel(middle + ivec3(i % 3, i / 3 % 3, i / 9) - 1, place);
    most = max(most, fine[i].a);
  }
  vec4 value = vec4(0.0);
  if (most > 0.0 && rule == kAverage) {
    for (int i = 0; i < 27; ++i) value += float((2 - abs(i % 3 - 1)) * (2 - abs(i / 3 % 3 - 1)) * (2 - abs(i / 9 - 1))) * fine[i];
    value /= 64.0;
  } else if (most > 0.0) {
    vec4 x = vec4(0.0), y = vec4(0.0), z = vec4(0.0);
    for (int v = 0; v < 3; ++v)
      for (int u = 0; u < 3; ++u) {
        float weight = float((2 - abs(u - 1)) * (2 - abs(v - 1))) / 32.0;  // of two ways
        x += weight * throughThree(fine[3 * u + 9 * v], fine[1 + 3 * u + 9 * v], fine[2 + 3 * u + 9 * v]);
        y += weight * throughThree(fine[u + 9 * v], fine[3 + u + 9 * v], fine[6 + u + 9 * v]);
        z += weight * throughThree(fine[u + 3 * v], fine[9 + u + 3 * v], fine[18 + u + 3 * v]);
      }
    value = facing(x, y, z);
  }
  ivec3 texel = texelOf(brick);
  imageStore(poolImage, texel + own, value);
}
