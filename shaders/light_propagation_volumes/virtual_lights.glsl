// Virtual point lights, summed per cell as integers, so that their order does not matter (common/integer_mean.glsl).
#include "common/integer_mean.glsl"
#include "parts.glsl"

struct VirtualLights {
  int shares[12];  // per channel the flux, and flux times normal, as shares of the largest possible sum in the cell
  uint brightest;  // the largest flux of a light, as the bits of a float
  uint lights;     // their number
};
layout(std430, binding = 2) buffer Sums { VirtualLights sums[]; };

// The index of a cell's sums, or -1 outside the grid.
int sumsOf(ivec3 cell, ivec3 resolution) {
  if (any(lessThan(cell, ivec3(0))) || any(greaterThanEqual(cell, resolution))) return -1;
  return (cell.z * resolution.y + cell.y) * resolution.x + cell.x;
}

float largestOf(vec3 flux) { return max(flux.r, max(flux.g, flux.b)); }

// Flux of the share 1, W; 0 without lights.
float fullFlux(int place) { return uintBitsToFloat(sums[place].brightest) * float(sums[place].lights); }

void addVirtualLight(int place, vec3 flux, vec3 normal) {
  float full = fullFlux(place);
  if (!(full > 0.0)) return;
  for (int channel = 0; channel < 3; ++channel) {
    float share = flux[channel] / full;
    if (share == 0.0) continue;
    ivec4 addend = signedShareOf(vec4(share, share * normal));
    for (int i = 0; i < 4; ++i)
      if (addend[i] != 0) atomicAdd(sums[place].shares[4 * channel + i], addend[i]);
  }
}
