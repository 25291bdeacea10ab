#version 450
// One iteration of the propagation (Kaplanyan & Dachsbacher 2010, Sec. 4.3; thesis 004 Sec. 4.3.3), gathered from the six neighbours.
// A work group is a brick of 4 x 4 x 4 cells, one cell per invocation. The stamp of a brick is the iteration in which light was last
// written to it: bricks without light in themselves and their neighbours are skipped. Light after n iterations has the stamp n + 1.
#include "propagation.glsl"
#include "crossing.glsl"

layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(binding = 4) uniform usampler3D stamps;
layout(binding = 6, r32ui) uniform uimage3D stampsNext;

bool lit(ivec3 brick) {
  ivec3 bricks = textureSize(stamps, 0);
  if (any(lessThan(brick, ivec3(0))) || any(greaterThanEqual(brick, bricks))) return false;
  return texelFetch(stamps, brick, 0).r == uint(stamp);
}

// Sum of crossFace() over the six neighbours, by sums and differences of the two neighbours along each
// axis, so that each constant is used once.
vec4 fromNeighbours(sampler3D light, ivec3 cell, ivec3 below, ivec3 above, vec3 openBelow, vec3 openAbove, vec3 turnBelow, vec3 turnAbove) {
  vec4 xBelow = openBelow.x * texelFetch(light, ivec3(below.x, cell.yz), 0);
  vec4 xAbove = openAbove.x * texelFetch(light, ivec3(above.x, cell.yz), 0);
  vec4 yBelow = openBelow.y * texelFetch(light, ivec3(cell.x, below.y, cell.z), 0);
  vec4 yAbove = openAbove.y * texelFetch(light, ivec3(cell.x, above.y, cell.z), 0);
  vec4 zBelow = openBelow.z * texelFetch(light, ivec3(cell.xy, below.z), 0);
  vec4 zAbove = openAbove.z * texelFetch(light, ivec3(cell.xy, above.z), 0);
  xBelow.w *= turnBelow.x;
  xAbove.w *= turnAbove.x;
  yBelow.y *= turnBelow.y;
  yAbove.y *= turnAbove.y;
  zBelow.z *= turnBelow.z;
  zAbove.z *= turnAbove.z;
  vec4 x = xBelow + xAbove, y = yBelow + yAbove, z = zBelow + zAbove;
  float inwards = (xBelow.w - xAbove.w) + (yBelow.y - yAbove.y) + (zBelow.z - zAbove.z);
  // In the order of the harmonics: y, z, x.
  vec3 differences = vec3(yBelow.x - yAbove.x, zBelow.x - zAbove.x, xBelow.x - xAbove.x);
  vec3 along = vec3(y.y, z.z, x.w), across = vec3(z.y + x.y, x.z + y.z, y.w + z.w);
  return vec4(kStay0 * (x.x + y.x + z.x) + kGain * inwards, turnShare() * differences + stayAlong() * along + stayAcross() * across);
}

void main() {
  // This branch is uniform over a group: the stamps that are read are not written in this pass.
  ivec3 brick = ivec3(gl_WorkGroupID), cell = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(cell, resolution))) return;
  bool reached = lit(brick) || lit(brick - ivec3(1, 0, 0)) || lit(brick + ivec3(1, 0, 0)) || lit(brick - ivec3(0, 1, 0)) ||
                lit(brick + ivec3(0, 1, 0)) || lit(brick - ivec3(0, 0, 1)) || lit(brick + ivec3(0, 0, 1));
  if (!reached) {
    // The target may still hold light of two iterations ago.
    if (imageLoad(stampsNext, brick).r == uint(stamp - 1)) {
      imageStore(redNext, cell, vec4(0.0));
      imageStore(greenNext, cell, vec4(0.0));
      imageStore(blueNext, cell, vec4(0.0));
    }
    return;
  }
  ivec3 end = resolution - 1;
  ivec3 below = max(cell - 1, ivec3(0)), above = min(cell + 1, end);
  vec3 occludedBelow = texelFetch(occluded, cell, 0).xyz;
  vec3 openBelow = vec3(openShare(occludedBelow.x), openShare(occludedBelow.y), openShare(occludedBelow.z));
  vec3 openAbove = vec3(openShare(texelFetch(occluded, ivec3(above.x, cell.yz), 0).x),
                        openShare(texelFetch(occluded, ivec3(cell.x, above.y, cell.z), 0).y),
                        openShare(texelFetch(occluded, ivec3(cell.xy, above.z), 0).z));
  // Beyond the border there is no light, or the mirror image of this cell: the same light, reversed along the axis.
  vec3 turnBelow = vec3(1.0), turnAbove = vec3(1.0);
  bvec3 firstCell = equal(cell, ivec3(0)), lastCell = equal(cell, end);
  if (any(firstCell) || any(lastCell)) {
    openBelow = mix(openBelow, vec3(mirrors), firstCell);
    openAbove = mix(openAbove, vec3(mirrors), lastCell);
    turnBelow = mix(turnBelow, vec3(-1.0), firstCell);
    turnAbove = mix(turnAbove, vec3(-1.0), lastCell);
  }
  vec4 redSum = amplifier * fromNeighbours(red, cell, below, above, openBelow, openAbove, turnBelow, turnAbove);
  vec4 greenSum = amplifier * fromNeighbours(green, cell, below, above, openBelow, openAbove, turnBelow, turnAbove);
  vec4 blueSum = amplifier * fromNeighbours(blue, cell, below, above, openBelow, openAbove, turnBelow, turnAbove);
  store(cell, redSum, greenSum, blueSum);
  // All invocations with light write the same word.
  if (any(notEqual(abs(redSum) + abs(greenSum) + abs(blueSum), vec4(0.0)))) imageStore(stampsNext, brick, uvec4(stamp + 1));
}
