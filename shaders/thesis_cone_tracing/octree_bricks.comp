#version 450
// Writes the bricks of the leaves from the sums: radiance pre-multiplied by opacity, and opacity.
// If voxels lie in leaves (octreeAtCorners 0), each vertex is the mean of the voxels of its own leaf around it (Sec. 4.2.2, Fig. 69:
// averages are stored in the corners of the brick, Listing 4.23, and spread through it).
// octree_transfer.comp then averages it with the neighbours.
// If voxels lie at corners (1), each brick gets its own eight voxels; those that it shares with the higher neighbour are copied from there.
layout(local_size_x = 64) in;
#include "octree_levels.glsl"
#include "octree_sums.glsl"

layout(std140, binding = 0) uniform Leaves {
  int coverageSum;   // opacity of a voxel: 1: the sum of its coverages, at most 1; 0: their mean
  int keepsOpacity;  // 1: the opacity is read from `opaque`
};
layout(binding = 0) uniform sampler3D opaque;
layout(binding = 0) uniform writeonly image3D poolImage;

vec4 meanIn(VoxelSums sum) {
  vec4 value = meanOf(uvec4(sum.red, sum.green, sum.blue, sum.coverage));
  if (coverageSum != 0) {
    // The sums hold means over the fragments; radiance over opacity does not change.
    float opacity = min(value.a * float(sum.items), 1.0);
    value = vec4(value.a > 0.0 ? value.rgb * (opacity / value.a) : vec3(0.0), opacity);
  }
  return vec4(value.rgb * uintBitsToFloat(sum.brightest), min(value.a, 1.0));
}

void main() {
  uint brick, lane;
  if (!itemOf(octreeDepth, kBrickVoxels, brick, lane)) return;
  ivec3 vertex = ivec3(lane % 3u, lane / 3u % 3u, lane / 9u), low = vertex, high = vertex;
  if (octreeAtCorners == 0) {
    low = max(vertex - 1, 0);
    high = min(vertex, 1);
  }
  vec4 value = vec4(0.0);
  if (all(lessThan(high, ivec3(2)))) {
    for (int z = low.z; z <= high.z; ++z)
      for (int y = low.y; y <= high.y; ++y)
        for (int x = low.x; x <= high.x; ++x) value += meanIn(sums[sumsOf(brick, uint(x | y << 1 | z << 2))]);
    ivec3 count = high - low + 1;
    value /= float(count.x * count.y * count.z);
  }
  if (keepsOpacity != 0) value.a = texelFetch(opaque, texelOf(brick) + vertex, 0).a;
  imageStore(poolImage, texelOf(brick) + vertex, value);
}
