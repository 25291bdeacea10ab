#version 450
// Li et al. 2005 (thesis 004 Sec. 2.1.1): the whole scene in orthogonal projection along an axis.
#include "orthogonal_view.glsl"
