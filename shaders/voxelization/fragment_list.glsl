// A list of fragments to append to: an invocation reserves an index by adding to fragmentCount, and writes if it is below the capacity.
#include "common/voxel.glsl"
#include "list_grid.glsl"
layout(std430, binding = 7) buffer Count { uint fragmentCount; };
layout(std430, binding = 8) writeonly buffer Fragments { VoxelFragment fragments[]; };
