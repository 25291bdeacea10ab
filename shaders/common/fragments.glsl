// One invocation per fragment of a list (common/voxel.glsl). Included after the local size, which is along x only.
// C++ side: port VoxelFragments, forEachFragment() in framework/include/lumivox/toolkit/bindings.h.
#ifndef LUMIVOX_FRAGMENTS
#define LUMIVOX_FRAGMENTS
#include "common/voxel.glsl"
#include "common/list.glsl"

layout(std430, binding = 0) readonly buffer FragmentCount { uint fragmentCount; };
layout(std430, binding = 1) readonly buffer Fragments { VoxelFragment fragments[]; };

#endif
