// The voxel that contains a point.
layout(std140, binding = 0) uniform Grid {
  vec3 gridLow;     // m, relative to the snapshot's origin
  float voxelSize;  // m
};

ivec3 voxelAt(vec3 posWorld) { return ivec3(floor((posWorld - gridLow) / voxelSize)); }
