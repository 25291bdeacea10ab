#version 450
// Kaplanyan & Dachsbacher 2010, Sec. 4.1: every texel of the reflective shadow map is a virtual point light. STEP weigh: the number of
// lights in a cell and the largest flux; STEP add: their sums.
#pragma lumivox axis STEP weigh add
#include "virtual_lights.glsl"
#include "beside_walls.glsl"
#if STEP == STEP_WEIGH
#define MARKS_BRICKS
#include "bricks.glsl"
#endif

layout(local_size_x = 8, local_size_y = 8) in;

#include "cell_grid.glsl"
layout(binding = 0) uniform sampler2DArray rsmPosition;
layout(binding = 1) uniform sampler2DArray rsmNormal;
layout(binding = 2) uniform sampler2DArray rsmFlux;

void main() {
  ivec3 texel = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(texel, textureSize(rsmFlux, 0)))) return;
  vec3 flux = texelFetch(rsmFlux, texel, 0).rgb;
  if (!any(greaterThan(flux, vec3(0.0)))) return;
  vec3 normal = texelFetch(rsmNormal, texel, 0).xyz;
  vec3 position = (texelFetch(rsmPosition, texel, 0).xyz - gridLow) / cellSize;
  ivec3 cell = cellBeside(position, normal);
  int place = sumsOf(cell, resolution);
  if (place < 0) return;
#if STEP == STEP_WEIGH
  // The bits of non-negative floats order like the floats.
  atomicMax(sums[place].brightest, floatBitsToUint(largestOf(flux)));
  if (atomicAdd(sums[place].lights, 1u) == 0u) markBrick(cell, resolution);
#else
  addVirtualLight(place, flux, normal);
#endif
}
