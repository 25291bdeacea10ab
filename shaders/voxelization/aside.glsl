// Items that would keep one thread too long: put aside by one dispatch and shared out over many threads by the next, whose size the device
// finds out by itself. C++ side: aside.h.
layout(std430, binding = 9) buffer Aside {
  uint asideGroupsX, asideGroupsY, asideGroupsZ;  // of that dispatch
  uint asideCount;
  uint aside[];
};

const uint kMostItemsAtOnce = 64u;  // the groups of a row go on to further items

void putAside(int item) {
  uint index = atomicAdd(asideCount, 1u);
  aside[index] = uint(item);
  atomicMax(asideGroupsX, min(index + 1u, kMostItemsAtOnce));
}
