// The children of a voxel of a clipmap in the next finer level, as that level is read: inner voxels where they exist, otherwise own voxels.

// The uniforms of a level, read once.
struct LevelBlocks {
  ivec4 ownFirst, ownEnd, ownTexel, ownStart;
  ivec4 innerFirst, innerEnd, innerTexel, innerStart;
};
LevelBlocks blocksOf(int level) {
  return LevelBlocks(ownFirst[level], ownEnd[level], ownTexel[level], ownStart[level], innerFirst[level], innerEnd[level], innerTexel[level],
                     innerStart[level]);
}
bool isIn(ivec4 first, ivec4 end, ivec3 voxel) {
  return all(greaterThanEqual(voxel, first.xyz)) && all(lessThan(voxel, end.xyz));
}
ClipmapPlace readPlace(LevelBlocks blocks, ivec3 voxel) {
  bool inner = isIn(blocks.innerFirst, blocks.innerEnd, voxel);
  return placeIn(inner ? blocks.innerFirst : blocks.ownFirst, inner ? blocks.innerEnd : blocks.ownEnd,
                 inner ? blocks.innerTexel : blocks.ownTexel, inner ? blocks.innerStart : blocks.ownStart, voxel);
}
ivec3 childOf(ivec3 voxel, int i) { return 2 * voxel + ivec3(i & 1, i >> 1 & 1, i >> 2); }
// Whether a child lies in its level: a voxel at the border of the coarsest level may have children outside.
bool isOfLevel(LevelBlocks blocks, ivec3 voxel) { return isIn(blocks.ownFirst, blocks.ownEnd, voxel); }
