#version 450
// The light before the first iteration: the injected light, and the light that enters across the border, from the next coarser grid or from
// the environment. Only the sum over all iterations counts, so that the light across the border may enter all at once.
#pragma lumivox axis OUTSIDE none grid environment
#include "cells.glsl"

layout(constant_id = 0) const int cosineLobe = 0;
#include "crossing.glsl"

layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

#include "cell_grid.glsl"
layout(std140, binding = 0) uniform Parameters {
  float outsideShare;   // light in a cell of this size over the light in a cell of the outside grid
  vec3 cellInOutside;   // size of a cell in texture coordinates of the outside grid
  float occlusion;
  vec3 lowInOutside;    // low corner of the grid in these coordinates
  vec4 environment;     // mean light in a cell of this size, W/sr
  vec4 environmentSlope[3];  // of red, green and blue: xyz the coefficients of band 1 in the order of a cell's light, W/sr
};
layout(binding = 0) uniform sampler3D red;
layout(binding = 1) uniform sampler3D green;
layout(binding = 2) uniform sampler3D blue;
layout(binding = 3) uniform sampler3D occluded;
#if OUTSIDE == OUTSIDE_GRID
layout(binding = 4) uniform sampler3D redOutside;
layout(binding = 5) uniform sampler3D greenOutside;
layout(binding = 6) uniform sampler3D blueOutside;
#endif
layout(binding = 0, rgba32f) uniform writeonly image3D redNext;
layout(binding = 1, rgba32f) uniform writeonly image3D greenNext;
layout(binding = 2, rgba32f) uniform writeonly image3D blueNext;
layout(binding = 3, rgba32f) uniform writeonly image3D redTotal;
layout(binding = 4, rgba32f) uniform writeonly image3D greenTotal;
layout(binding = 5, rgba32f) uniform writeonly image3D blueTotal;
layout(binding = 6, r32ui) uniform writeonly uimage3D stampsNext;

void main() {
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(cell, resolution))) return;
  vec4 light[3] = vec4[3](texelFetch(red, cell, 0), texelFetch(green, cell, 0), texelFetch(blue, cell, 0));
#if OUTSIDE != OUTSIDE_NONE
  for (int face = 0; face < 6; ++face) {
    int axis = face >> 1, side = 1 - 2 * (face & 1);
    ivec3 offset = ivec3(0);
    offset[axis] = side;
    ivec3 source = cell - offset;
    if (source[axis] >= 0 && source[axis] < resolution[axis]) continue;
    float open = 1.0 - clamp(occlusion * texelFetch(occluded, max(cell, source), 0)[axis], 0.0, 1.0);
    vec4 along = vec4(0.0, vec3(offset.yzx));
#if OUTSIDE == OUTSIDE_GRID
    vec3 texcoord = lowInOutside + (vec3(source) + 0.5) * cellInOutside;
    light[0] += open * crossFace(texture(redOutside, texcoord) * outsideShare, along);
    light[1] += open * crossFace(texture(greenOutside, texcoord) * outsideShare, along);
    light[2] += open * crossFace(texture(blueOutside, texcoord) * outsideShare, along);
#else
    // The mean over all directions: c0 = I / Y0.
    for (int channel = 0; channel < 3; ++channel)
      light[channel] += open * crossFace(vec4(environment[channel] / kY0, environmentSlope[channel].xyz), along);
#endif
  }
#endif
  imageStore(redNext, cell, light[0]);
  imageStore(greenNext, cell, light[1]);
  imageStore(blueNext, cell, light[2]);
  imageStore(redTotal, cell, light[0]);
  imageStore(greenTotal, cell, light[1]);
  imageStore(blueTotal, cell, light[2]);
  if (any(notEqual(abs(light[0]) + abs(light[1]) + abs(light[2]), vec4(0.0)))) imageStore(stampsNext, cell / 4, uvec4(1u));
}
