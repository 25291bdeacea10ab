#version 450
// Converts collected virtual point lights to spherical harmonics: a light of flux F and normal n has the intensity
//   F / (4 pi) (1 + 3 m n . w),  m its mean cosine: c0 = Y0 F, c1 = m Y1 F n.
// Deviates from thesis 004 Listing 4.31, a clamped cosine (m = 2/3): see README, "injection".
#include "cells.glsl"
#include "virtual_lights.glsl"
#include "bricks.glsl"

layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

#include "cell_grid.glsl"
layout(std140, binding = 0) uniform Parameters {
  float meanCosine;    // 0: the value at which no flux leaves backwards
};
layout(binding = 0, rgba32f) uniform writeonly image3D red;
layout(binding = 1, rgba32f) uniform writeonly image3D green;
layout(binding = 2, rgba32f) uniform writeonly image3D blue;

void main() {
  ivec3 cell = listedCell();
  if (any(greaterThanEqual(cell, resolution))) return;
  int place = sumsOf(cell, resolution);
  // fluxAcross the face behind the light is 0: kCrossing0 Y0 = kCrossing1 m Y1.
  float cosine = meanCosine > 0.0 ? meanCosine : kCrossing0 * kY0 / (kCrossing1 * kY1);
  vec4 unit = vec4(kY0, vec3(cosine * kY1)) * (fullFlux(place) / kSignedFixedPoint);
  vec4 channels[3];
  for (int i = 0; i < 3; ++i) {
    ivec4 sum = ivec4(sums[place].shares[4 * i], sums[place].shares[4 * i + 1], sums[place].shares[4 * i + 2], sums[place].shares[4 * i + 3]);
    channels[i] = vec4(sum).xzwy * unit;  // from x, y, z to the order of the harmonics
  }
  imageStore(red, cell, channels[0]);
  imageStore(green, cell, channels[1]);
  imageStore(blue, cell, channels[2]);
}
