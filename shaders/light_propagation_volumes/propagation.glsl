// Shared by propagate.comp and propagate_plain.comp.
#include "cells.glsl"

layout(constant_id = 0) const int cosineLobe = 0;  // 1: flux leaves again as a clamped cosine around the face, as published

layout(std140, binding = 0) uniform Parameters {
  ivec3 resolution;
  int stamp;        // of the light that is read; see propagate.comp
  float amplifier;  // factor on the flux
  float occlusion;  // amplifier of the occluded share of a face
  int mirrors;      // 1: the border of the grid reflects light; 0: light that crosses it is lost
  int addToTotal;   // 1: the new light also counts in the sum over all iterations
};
layout(binding = 0) uniform sampler3D red;
layout(binding = 1) uniform sampler3D green;
layout(binding = 2) uniform sampler3D blue;
layout(binding = 3) uniform sampler3D occluded;
layout(binding = 0, rgba32f) uniform writeonly image3D redNext;
layout(binding = 1, rgba32f) uniform writeonly image3D greenNext;
layout(binding = 2, rgba32f) uniform writeonly image3D blueNext;
layout(binding = 3, rgba32f) uniform image3D redTotal;
layout(binding = 4, rgba32f) uniform image3D greenTotal;
layout(binding = 5, rgba32f) uniform image3D blueTotal;

// W: limit for light that grows without bound by an amplifier above 1 or by the published sum. Its sums, products with albedos and squares
// are still finite.
const float kMostFlux = 1e18;

vec4 bounded(vec4 flux) { return clamp(flux, vec4(-kMostFlux), vec4(kMostFlux)); }

void store(ivec3 cell, vec4 redSum, vec4 greenSum, vec4 blueSum) {
  redSum = bounded(redSum);
  greenSum = bounded(greenSum);
  blueSum = bounded(blueSum);
  imageStore(redNext, cell, redSum);
  imageStore(greenNext, cell, greenSum);
  imageStore(blueNext, cell, blueSum);
  if (addToTotal == 0) return;
  imageStore(redTotal, cell, imageLoad(redTotal, cell) + redSum);
  imageStore(greenTotal, cell, imageLoad(greenTotal, cell) + greenSum);
  imageStore(blueTotal, cell, imageLoad(blueTotal, cell) + blueSum);
}

// Open share of a face with this occluded share.
float openShare(float occludedShare) { return 1.0 - clamp(occlusion * occludedShare, 0.0, 1.0); }
