// The levels of a clipmap side by side, as one grid of which each level is a cube: how fragments and their sums number the voxels of all
// levels. A row of cubes lies along z, the rows along y.
// C++ side: ClipmapStack in techniques/voxel_cone_tracing/clipmap/clipmap.cpp.
#ifndef LUMIVOX_CLIPMAP_STACK
#define LUMIVOX_CLIPMAP_STACK
const int kMostStacked = 12;
layout(std140, binding = 5) uniform ClipmapStack {
  vec3 stackOrigin;  // corner of voxel (0,0,0) of all levels, m
  float stackVoxel;  // finest voxels, m
  int stackSide;     // voxels along a cube
  int stackRow;      // cubes
  ivec4 stackFirst[kMostStacked];   // voxel of the level at the corner of its cube
  vec4 stackLimits[kMostStacked];   // most radiance that a voxel of the level can send, W/(sr m^2); voxels along the whole scene
};

int levelInStack(ivec3 voxel) {
  ivec3 cube = voxel / stackSide;
  return cube.y * stackRow + cube.z;
}
ivec3 cornerInStack(int level) { return stackSide * ivec3(0, level / stackRow, level % stackRow); }
ivec3 voxelOfLevel(ivec3 voxel, int level) { return voxel - cornerInStack(level) + stackFirst[level].xyz; }
float voxelSizeOf(int level) { return stackVoxel * exp2(float(level)); }

#endif
