// Items with too much work for one thread: one dispatch puts them aside; the next, an indirect dispatch, spreads each over many threads.
// C++ side: aside.h.
layout(std430, binding = 9) buffer Aside {
  uint asideGroupsX, asideGroupsY, asideGroupsZ;  // of the dispatch over the items
  uint asideCount;
  uint aside[];
};

const uint kMostItemsAtOnce = 64u;  // the work groups of a row loop over further items

void putAside(int item) {
  uint index = atomicAdd(asideCount, 1u);
  aside[index] = uint(item);
  atomicMax(asideGroupsX, min(index + 1u, kMostItemsAtOnce));
}
