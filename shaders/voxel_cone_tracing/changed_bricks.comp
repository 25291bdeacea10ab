#version 450
// Clears the occupied voxels of the bricks in changed cells. The place of a brick's sums is replaced by whether any voxel was occupied, so
// that bricks that have become empty are found too.
#include "bricks.glsl"
layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;
#include "toolkit/changed_cells.glsl"

layout(std140, binding = 0) uniform Size { ivec3 brickCount; };
layout(std430, binding = 3) buffer Bricks { Brick bricks[]; };

void main() {
  ivec3 place = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(place, brickCount)) || !isChanged(cellOf(4 * place), cellDepth)) return;
  uint index = brickOf(4 * place, brickCount);
  bricks[index] = Brick(0u, 0u, min(bricks[index].low | bricks[index].high, 1u));
}
