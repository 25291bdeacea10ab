// The grid and where a pixel is sampled.
const int kMostSamples = 8;
layout(std140, binding = 1) uniform SampleGrid {
  vec3 gridLow;     // m
  float voxelSize;  // m
  ivec3 resolution;
  int firstIndex;   // of this draw
  int capacity;     // fragments that fit into the list
  int sampleCount;
  float thickness;  // voxels
  int scale;        // pixels along a side of a voxel, in this viewport
  int mostScale;
  vec4 samples[kMostSamples];  // x and y inside the pixel, 0..1
};
