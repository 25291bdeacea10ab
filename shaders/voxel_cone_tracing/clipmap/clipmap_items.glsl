// Lists of voxels of a clipmap that need work, each with the dispatch over its items: most voxels are empty or stay as they are, and a pass
// that is heavy is run for the others alone. A work group takes every gl_NumWorkGroups.x-th group of items.
#ifndef LUMIVOX_CLIPMAP_ITEMS
#define LUMIVOX_CLIPMAP_ITEMS
#include "common/list.glsl"

const uint kItemGroup = 64u;  // invocations

struct ListHead {
  uint count;
  uint groupsX, groupsY, groupsZ;
};
#ifdef ITEMS_BUILD
layout(std430, binding = 11) buffer ListHeads { ListHead heads[]; };
layout(std430, binding = 12) writeonly buffer ListItems { uint items[]; };

// `each`: invocations for an item.
void putItem(int list, uint item, uint each) {
  uint place = atomicAdd(heads[list].count, 1u);
  items[place] = item;
  atomicMax(heads[list].groupsX, min(place * each / kItemGroup + 1u, kMostGroups));
}
#else
layout(std430, binding = 11) readonly buffer ListHeads { ListHead heads[]; };
layout(std430, binding = 12) readonly buffer ListItems { uint items[]; };
#endif

#endif
