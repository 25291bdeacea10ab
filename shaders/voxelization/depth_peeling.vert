#version 450
// Li et al. 2005 (thesis 004 Sec. 2.1.1): the whole scene, seen along an axis.
#include "orthogonal_view.glsl"
