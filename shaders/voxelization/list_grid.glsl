// The grid of a list of fragments, and the capacity of the list.
#ifndef LUMIVOX_LIST_GRID
#define LUMIVOX_LIST_GRID
layout(std140, binding = 8) uniform ListGrid {
  vec3 gridLow;     // m
  float voxelSize;  // m
  ivec3 resolution;
  int capacity;
};
#endif
