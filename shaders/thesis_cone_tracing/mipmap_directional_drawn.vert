#version 450
// mipmap_directional.comp as a draw without attributes (Table 1).
#include "drawn.glsl"
#include "mipmap_directional.glsl"

void main() {
  ivec3 cell = voxelOfVertex(coarse);
  if (all(lessThan(cell, coarse))) mipmapCell(cell);
  drawNothing();
}
