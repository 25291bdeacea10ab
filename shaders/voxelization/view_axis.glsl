// The direction of an orthogonal view, and the part of the grid that it shows.
#include "common/triangle.glsl"
#include "list_grid.glsl"

layout(std140, binding = 1) uniform View {
  float side;       // pixels of the target
  int axis;
  float depthLow, depthHigh;  // voxels; nothing outside is drawn
};
