#version 450
// Lists the voxels of a level of a clipmap that clipmap_filter.comp has to make anew: those that hold anything, or did, and of which what they are
// made of differs from the frame before: their children, what was voxelized, the ramp between the two, or which voxel has its place. Notes
// them for the next coarser level.
//
// CELLS: what was voxelized differs in changed cells as well, and not only where the level has come to.
#pragma lumivox axis ABOVE 0 1
#pragma lumivox axis CELLS 0 1
layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;
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

// What a level had in the frame before: nothing where all is made anew.
struct Had {
  ivec4 ownFirst, ownEnd;  // w: bits of LevelEnds::endless
  ivec4 innerFirst, innerEnd;
};
layout(std140, binding = 0) uniform Level {
  ivec3 firstMade;  // voxels that are looked at, and addresses of the block that hold none
  int level;
  ivec3 endMade;
  int unused;
  Had had, finerHad;
};
// By places, as the bits of what is occupied.
layout(std430, binding = 5) buffer MadeAnew { uint madeAnew[]; };

bool isMadeAnew(ClipmapPlace place) { return (madeAnew[place.word] & place.bit) != 0u; }
bool isIn(ivec4 first, ivec4 end, ivec3 voxel) {
  return all(greaterThanEqual(voxel, first.xyz)) && all(lessThan(voxel, end.xyz));
}

// Whether what was voxelized differs, of a level around the camera.
bool differsAsVoxelized(int of, Had before, ivec3 voxel) {
  if (!isIn(before.ownFirst, before.ownEnd, voxel)) return true;
#if CELLS
  return clipmapCells[cellIndex(of, voxel - ownFirst[of].xyz, ownFirst[of].w)] != 0u;
#else
  return false;
#endif
}
// Whether a child differs as it is read.
bool differsAsRead(int finer, ivec3 voxel, ClipmapPlace place) {
  if (finer >= clipmapLevels) return !isIn(finerHad.ownFirst, finerHad.ownEnd, voxel) || isMadeAnew(place);
  bool wasInner = isIn(finerHad.innerFirst, finerHad.innerEnd, voxel);
  if (isInner(finer, voxel)) return !wasInner || isMadeAnew(place);
  return wasInner || differsAsVoxelized(finer, finerHad, voxel);
}

void main() {
  ivec3 voxel = firstMade + ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(voxel, endMade))) return;
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
  if (isVoxel && share < 1.0) {
    occupied = occupied || isOccupied(ownPlace(level, voxel));
    differs = differs || differsAsVoxelized(level, had, voxel);
  }
#endif
  if (isVoxel && share > 0.0)
    for (int i = 0; i < 8; ++i) {
      ivec3 child = childOf(voxel, i);
      if (isOfLevel(level - 1, child)) {
        ClipmapPlace of = readPlace(level - 1, child);
        occupied = occupied || isOccupied(of);
        differs = differs || differsAsRead(level - 1, child, of);
      } else {
        differs = differs || isIn(finerHad.ownFirst, finerHad.ownEnd, child);
      }
    }
  if (!differs || !occupied) return;
  putItem(level, packVoxel(voxel - firstMade));
  atomicOr(madeAnew[place.word], place.bit);
}
