// The place of a voxel of a clipmap as the coarser level reads it: of what the level shares with the finer one, as that one makes it.
ClipmapPlace readPlace(int level, ivec3 voxel) {
  bool inner = isInner(level, voxel);
  return placeIn(inner ? innerFirst[level] : ownFirst[level], inner ? innerEnd[level] : ownEnd[level], inner ? innerTexel[level] : ownTexel[level],
                 inner ? innerStart[level] : ownStart[level], voxel);
}
ivec3 childOf(ivec3 voxel, int i) { return 2 * voxel + ivec3(i & 1, i >> 1 & 1, i >> 2); }
// A voxel at the border of the coarsest level may reach beyond it.
bool isOfLevel(int level, ivec3 voxel) {
  return all(greaterThanEqual(voxel, ownFirst[level].xyz)) && all(lessThan(voxel, ownEnd[level].xyz));
}
