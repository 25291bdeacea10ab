// How an occupied voxel receives light for the next bounce.
#include "surface_sides.glsl"
layout(constant_id = 12) const int feedsOwn = 0;  // 1: by its own coefficients; 0: like a surface at its centre
