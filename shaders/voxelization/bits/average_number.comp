#version 450
#include "common/slots_number.glsl"
