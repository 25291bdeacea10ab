// The levels of a clipmap side by side as cubes of one grid, in which fragments and their sums address the voxels of all levels. Rows of
// cubes run along z; the rows follow each other along y.
// C++ side: ClipmapStack in techniques/voxel_cone_tracing/clipmap/clipmap.cpp.
#ifndef LUMIVOX_CLIPMAP_STACK
#define LUMIVOX_CLIPMAP_STACK
const int kMostStacked = 12;
layout(std140, binding = 5) uniform ClipmapStack {
  vec3 stackOrigin;  // corner of voxel (0,0,0) of all levels, m
  float stackVoxel;  // size of the finest voxels, m
  int stackSide;     // voxels along a side of a cube
  int stackRow;      // cubes per row
  ivec4 stackFirst[kMostStacked];   // voxel of the level at the corner of its cube
  vec4 stackLimits[kMostStacked];   // x limit of the radiance of a voxel of the level, W/(sr m^2); y voxels along the whole scene
};

int levelInStack(ivec3 voxel) {
  ivec3 cube = voxel / stackSide;
  return cube.y * stackRow + cube.z;
}
ivec3 cornerInStack(int level) { return stackSide * ivec3(0, level / stackRow, level % stackRow); }
ivec3 voxelOfLevel(ivec3 voxel, int level) { return voxel - cornerInStack(level) + stackFirst[level].xyz; }
float voxelSizeOf(int level) { return stackVoxel * exp2(float(level)); }

#endif
