// Which way an orthogonal view looks, and what part of the grid it sees.
#include "common/triangle.glsl"
#include "list_grid.glsl"

layout(std140, binding = 1) uniform View {
  float side;       // pixels of the target
  int axis;
  float depthLow, depthHigh;  // voxels; nothing outside is drawn
};
