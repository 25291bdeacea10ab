#version 450
// Pre-filtering of one level as a draw without attributes (thesis 004 Table 1), one vertex for each voxel of the coarse level.
#include "filter_cell.glsl"
#include "drawn.glsl"

void main() {
  ivec3 cell = voxelOfVertex(coarse);
  if (all(lessThan(cell, coarse))) filterCell(cell);
  drawNothing();
}
