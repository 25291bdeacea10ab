// Virtual point lights, collected per cell as integers, so that their order does not matter. A cell has fourteen words: for each colour
// the flux and the sum of flux times normal, as signed shares of what its lights can add up to, and what that is: the largest flux
// among them, and their number. The unit is the cell's own, so that dark cells beside very bright ones keep their light.
#include "parts.glsl"

const int kBrightest = 12, kLights = 13, kWordsOfCell = 14;
layout(std430, binding = 2) buffer Sums { uint sums[]; };

// The first of a cell's words, or -1 outside the grid.
int wordsOf(ivec3 cell, ivec3 resolution) {
  if (any(lessThan(cell, ivec3(0))) || any(greaterThanEqual(cell, resolution))) return -1;
  return ((cell.z * resolution.y + cell.y) * resolution.x + cell.x) * kWordsOfCell;
}

float largestOf(vec3 flux) { return max(flux.r, max(flux.g, flux.b)); }

// W of the share 1; 0 where nothing shines.
float fullFlux(int word) { return uintBitsToFloat(sums[word + kBrightest]) * float(sums[word + kLights]); }

void addVirtualLight(int word, vec3 flux, vec3 normal) {
  float full = fullFlux(word);
  if (!(full > 0.0)) return;
  for (int channel = 0; channel < 3; ++channel) {
    // Half of the range is for the sign.
    float share = flux[channel] / full * (0.5 * kFixedPoint);
    if (share == 0.0) continue;
    ivec4 addend = ivec4(round(vec4(share, share * normal)));
    for (int i = 0; i < 4; ++i)
      if (addend[i] != 0) atomicAdd(sums[word + 4 * channel + i], uint(addend[i]));
  }
}
