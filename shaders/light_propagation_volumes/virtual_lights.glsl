// Virtual point lights, collected per cell as integers, so that their order does not matter. A cell has twelve words: for each colour the
// flux and the sum of flux times normal, as signed shares of the largest flux that there can be.
#include "parts.glsl"

const int kWordsOfCell = 12;
layout(std430, binding = 2) buffer Sums { uint sums[]; };

void addVirtualLight(ivec3 cell, ivec3 resolution, vec3 flux, vec3 normal, float largestFlux) {
  if (any(lessThan(cell, ivec3(0))) || any(greaterThanEqual(cell, resolution))) return;
  int word = ((cell.z * resolution.y + cell.y) * resolution.x + cell.x) * kWordsOfCell;
  for (int channel = 0; channel < 3; ++channel) {
    // Half of the range is for the sign. The sum of all fluxes is at most largestFlux.
    float share = flux[channel] / largestFlux * (0.5 * kFixedPoint);
    if (share == 0.0) continue;
    ivec4 addend = ivec4(round(vec4(share, share * normal)));
    for (int i = 0; i < 4; ++i)
      if (addend[i] != 0) atomicAdd(sums[word + 4 * channel + i], uint(addend[i]));
  }
}
