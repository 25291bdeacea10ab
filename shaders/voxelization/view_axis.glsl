// Which way an orthogonal view looks, and what part of the grid it sees.
#include "triangle.glsl"

layout(std140, binding = 1) uniform View {
  vec3 gridLow;     // m
  float voxelSize;  // m
  ivec3 resolution;
  int capacity;     // fragments that fit into the list
  float side;       // pixels of the target
  int axis;
  float depthLow, depthHigh;  // voxels; nothing outside is drawn
};
