// The voxels of a cell of a clipmap's level; cells count from the first voxel of the level. All levels
// have room for the same number of cells.
void voxelsOfCell(int level, int cell, out ivec3 first, out ivec3 end) {
  int along = cellsAlong(ownFirst[0].w);
  first = ownFirst[level].xyz + 4 * ivec3(cell % along, cell / along % along, cell / (along * along));
  end = min(first + 4, ownEnd[level].xyz);
}
