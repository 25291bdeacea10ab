#version 450
// Forgets which voxels were occupied in the bricks of changed cells, and keeps whether any was, in place of the bricks' sums: what has
// become empty has to be found too.
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
