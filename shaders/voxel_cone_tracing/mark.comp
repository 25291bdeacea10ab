#version 450
// Sets the bits of the voxels that contain fragments.
#include "bricks.glsl"

layout(local_size_x = 64) in;
#include "toolkit/taken_fragments.glsl"

layout(std140, binding = 0) uniform Size { ivec3 brickCount; };
layout(std430, binding = 3) buffer Bricks { Brick bricks[]; };

void main() {
  uint index;
  if (!takenFragment(index)) return;
  ivec3 voxel = unpackVoxel(fragments[index].voxel);
  uint brick = brickOf(voxel, brickCount), bit = bitOf(voxel), mask = 1u << (bit & 31u);
  if (bit < 32u)
    atomicOr(bricks[brick].low, mask);
  else
    atomicOr(bricks[brick].high, mask);
}
