// The grid, and the sample positions of a pixel.
#include "list_grid.glsl"
const int kMostSamples = 8;
layout(std140, binding = 1) uniform SampleGrid {
  int firstIndex;   // of this draw
  int sampleCount;
  float thickness;  // voxels
  int scale;        // pixels along a side of a voxel, in this viewport
  int mostScale;
  vec4 samples[kMostSamples];  // x and y inside the pixel, 0..1
};
