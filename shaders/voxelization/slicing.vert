#version 450
// Fang & Chen 2000 (thesis 004 Sec. 2.1.1): the scene between two clip planes, one voxel apart.
#include "orthogonal_view.glsl"
