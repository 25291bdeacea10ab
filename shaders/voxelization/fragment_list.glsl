// A list of fragments that is appended to: who takes an index by adding to fragmentCount writes where it is below the capacity.
#include "common/voxel.glsl"
#include "list_grid.glsl"
layout(std430, binding = 7) buffer Count { uint fragmentCount; };
layout(std430, binding = 8) writeonly buffer Fragments { VoxelFragment fragments[]; };
