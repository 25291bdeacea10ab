// Placement of the cells of one of the nested grids.
layout(std140, binding = 8) uniform Cells {
  vec3 gridLow;    // m
  float cellSize;  // m
  ivec3 resolution;
};
