#version 450
#include "common/slots_claim.glsl"
