// Lists of the voxels of a clipmap that need work, each with the arguments of an indirect dispatch over its items: most voxels are empty or
// unchanged, and an expensive pass runs only for the others. A work group processes every gl_NumWorkGroups.x-th group of items.
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

// `each`: number of invocations per item.
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
