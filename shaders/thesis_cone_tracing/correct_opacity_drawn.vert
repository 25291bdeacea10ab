#version 450
// Listing 4.10 as a draw without attributes (Table 1).
#include "correct_opacity.glsl"
#include "drawn.glsl"

void main() {
  ivec3 voxel = voxelOfVertex(resolution);
  if (all(lessThan(voxel, resolution))) correctOpacity(voxel);
  drawNothing();
}
