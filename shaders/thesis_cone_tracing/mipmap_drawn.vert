#version 450
// mipmap.comp as a draw without attributes (Table 1).
#include "drawn.glsl"
#include "mipmap.glsl"

void main() {
  ivec3 cell = voxelOfVertex(coarse);
  if (all(lessThan(cell, coarse))) mipmapCell(cell);
  drawNothing();
}
