// How an occupied voxel takes up what arrives.
#include "surface_sides.glsl"
layout(constant_id = 12) const int feedsOwn = 0;  // 1: by its own coefficients; 0: as a surface in its middle
