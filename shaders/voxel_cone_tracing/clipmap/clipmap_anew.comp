#version 450
// Lists the voxels of a level of a clipmap that clipmap_filter.comp has to refilter. These are the voxels that are or were occupied and
// whose sources differ from the last frame: their children, their voxelized values, the ramp between the two, or the voxel at their
// address. Marks the listed voxels for the next coarser level.
//
// CELLS: voxelized values differ also in changed cells, not only where the level has moved to.
// LISTED: no level has moved: only the voxels of the cells listed by clipmap_coarser.comp are tested.
#pragma lumivox axis ABOVE 0 1
#pragma lumivox axis CELLS 0 1
#pragma lumivox axis LISTED 0 1
#pragma lumivox require !LISTED || CELLS
#if LISTED
layout(local_size_x = 64) in;
#else
layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;
#endif
#include "common/voxel.glsl"
#include "clipmap.glsl"
#include "clipmap_occupied.glsl"
#include "clipmap_children.glsl"
#include "clipmap_ramp.glsl"
#define ITEMS_BUILD
#include "clipmap_items.glsl"
#if CELLS
#include "clipmap_cells.glsl"
#endif
#if LISTED
#include "clipmap_cell_voxels.glsl"
layout(std430, binding = 9) readonly buffer CellHeads { ListHead cellHeads[]; };
layout(std430, binding = 10) readonly buffer CellItems { uint cellItems[]; };
#endif

// The voxels of a level in the last frame; none if all are refiltered.
struct Had {
  ivec4 ownFirst, ownEnd;  // w: bits of LevelEnds::endless
  ivec4 innerFirst, innerEnd;
};
layout(std140, binding = 0) uniform Level {
  ivec3 firstMade;  // range of tested voxels, including addresses of the block without a voxel
  int level;
  ivec3 endMade;
  int unused;
  Had had, finerHad;
};
// Bits of refiltered voxels, in the order of the occupancy bits.
layout(std430, binding = 5) buffer MadeAnew { uint madeAnew[]; };

// Whether the voxelized values of a voxel differ from the last frame, in level `of` around the camera, whose first voxel is `first`.
bool differsAsVoxelized(int of, ivec4 first, Had before, ivec3 voxel) {
  bool differs = !isIn(before.ownFirst, before.ownEnd, voxel);
#if CELLS
  differs = differs || clipmapCells[cellIndex(of, voxel - first.xyz, first.w)] != 0u;
#endif
  return differs;
}
// Whether the value that is read of a child differs from the last frame. Without branches, because most
// conditions are equal for all children.
bool differsAsRead(int finer, LevelBlocks blocks, ivec3 voxel, bool isAnew) {
  bool wasOwn = isIn(finerHad.ownFirst, finerHad.ownEnd, voxel), wasInner = isIn(finerHad.innerFirst, finerHad.innerEnd, voxel);
  bool inner = isIn(blocks.innerFirst, blocks.innerEnd, voxel);
  bool whereMade = isAnew || !(inner ? wasInner : wasOwn);
  bool isMade = inner || finer >= clipmapLevels;
#if CELLS
  if (isMade) return whereMade;
  return wasInner || differsAsVoxelized(finer, blocks.ownFirst, finerHad, voxel);
#else
  return isMade ? whereMade : wasInner || !wasOwn;
#endif
}

void look(ivec3 voxel) {
#if ABOVE
  bool isVoxel = all(lessThan(voxel, ownEnd[level].xyz)), was = isIn(had.ownFirst, had.ownEnd, voxel);
  ClipmapPlace place = ownPlace(level, voxel);
  float share = 1.0, shareBefore = 1.0;
#else
  bool isVoxel = all(lessThan(voxel, innerEnd[level].xyz)), was = isIn(had.innerFirst, had.innerEnd, voxel);
  ClipmapPlace place = innerPlace(level, voxel);
  float share = shareOfFiner(endsOf(level - 1), voxel),
        shareBefore = shareOfFiner(LevelEnds(finerHad.ownFirst.xyz, finerHad.ownEnd.xyz, uint(finerHad.ownFirst.w)), voxel);
#endif
  bool differs = !isVoxel || !was || share != shareBefore, occupied = isOccupied(place);
#if !ABOVE
  bool takesOwn = isVoxel && share < 1.0;
  occupied = occupied || (takesOwn && isOccupied(ownPlace(level, voxel)));
  differs = differs || (takesOwn && differsAsVoxelized(level, ownFirst[level], had, voxel));
#endif
  bool takesChildren = isVoxel && share > 0.0;
  LevelBlocks finer = blocksOf(level - 1);
  uint found = 0u;
  for (int i = 0; i < 8; ++i) {
    ivec3 child = childOf(voxel, i);
    bool there = isOfLevel(finer, child);
    ClipmapPlace of = readPlace(finer, child);
    uint word = there ? of.word : 0u, bit = there ? of.bit : 0u;
    found |= clipmapOccupied[word] & bit;
    bool anew = there ? differsAsRead(level - 1, finer, child, (madeAnew[word] & bit) != 0u) : isIn(finerHad.ownFirst, finerHad.ownEnd, child);
    differs = differs || (takesChildren && anew);
  }
  occupied = occupied || (takesChildren && found != 0u);
  if (!differs || !occupied) return;
  putItem(level, packVoxel(voxel - firstMade), 1u);
  atomicOr(madeAnew[place.word], place.bit);
}

#if LISTED
void main() {
  int lane = int(gl_LocalInvocationID.x);
  uint count = cellHeads[level].count;
  for (uint i = gl_WorkGroupID.x; i < count; i += gl_NumWorkGroups.x) {
    ivec3 first, end;
    voxelsOfCell(level, int(cellItems[i]), first, end);
    ivec3 voxel = first + ivec3(lane & 3, lane >> 2 & 3, lane >> 4);
    if (all(greaterThanEqual(voxel, firstMade)) && all(lessThan(voxel, min(end, endMade)))) look(voxel);
  }
}
#else
void main() {
  ivec3 voxel = firstMade + ivec3(gl_GlobalInvocationID);
  if (all(lessThan(voxel, endMade))) look(voxel);
}
#endif
