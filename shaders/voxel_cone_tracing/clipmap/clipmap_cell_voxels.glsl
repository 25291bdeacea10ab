// The voxels of a cell of a clipmap's level; cells of the level count from its first voxel. All levels have room for as many cells.
void voxelsOfCell(int level, int cell, out ivec3 first, out ivec3 end) {
  int along = cellsAlong(ownFirst[0].w);
  first = ownFirst[level].xyz + 4 * ivec3(cell % along, cell / along % along, cell / (along * along));
  end = min(first + 4, ownEnd[level].xyz);
}
