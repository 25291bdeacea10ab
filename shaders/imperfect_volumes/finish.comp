#version 450
#include "common/finish_count.glsl"
