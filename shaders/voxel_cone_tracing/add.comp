#version 450
// Averages the radiance that the fragments of a voxel reflect.
// Deviates from thesis 004 Listing 4.9, whose running average in 8 bits depends on the order of the writes and overflows past 255
// fragments. Here each fragment adds its share of an integer mean, in units of the brightest fragment of its voxel
// (common/integer_mean.glsl).
//
// DIRECTIONS: one average per face of the voxel, weighted by the cosine between the normals of face and fragment, so that the two sides of
// a wall stay separate. The back of a fragment has the small weight backWeight, so that it counts only for a face without fronts: the
// inside of a wall with both surfaces in one voxel is dark. A fragment's opacity along an axis is its coverage times the component of its
// normal along the axis over the largest component: a sheet is opaque along the axis that it faces and open along itself (alongAll: opaque
// along all axes).
//
// SAMPLED: `opacity` also stores the covered samples of the voxel's sides, beside the sum of the coverages.
#pragma lumivox axis DIRECTIONS 0 1
#pragma lumivox axis SAMPLED 0 1
#pragma lumivox require !SAMPLED || (DIRECTIONS && PLACES == clipmap && !CHANGED)
#pragma lumivox require PLACES != clipmap || DIRECTIONS
#include "bricks.glsl"
#include "common/integer_mean.glsl"

layout(local_size_x = 64) in;
#include "common/fragments.glsl"

layout(std140, binding = 0) uniform Averages {
  ivec3 brickCount;
  int coverageSum;   // DIRECTIONS: opacity of a voxel: 1: the sum of its coverages, at most 1; 0: the largest
  float backWeight;  // DIRECTIONS: weight of a fragment's back in the mean of a face; fronts have weight 1
  int alongAll;      // DIRECTIONS: 1: a fragment is opaque along all axes; 0: along those that it faces
};
layout(std430, binding = 2) readonly buffer Radiances { float radiances[]; };  // r, g, b per fragment or per side of a fragment, W/(sr m^2)
layout(std430, binding = 3) readonly buffer Bricks { Brick bricks[]; };
#include "sums.glsl"

vec3 radianceAt(uint first) { return vec3(radiances[first], radiances[first + 1], radiances[first + 2]); }

// Weighted radiance in units of the brightest fragment, and the weight.
vec4 partOf(vec3 radiance, float brightest, float weight) {
  return vec4(brightest > 0.0 ? min(radiance / brightest, 1.0) : vec3(0.0), 1.0) * weight;
}

#if DIRECTIONS
layout(std430, binding = 4) buffer DirectionalSums { VoxelDirections directions[]; };

#if SAMPLED
layout(std430, binding = 9) readonly buffer SideMasks { uint sideMasksOf[]; };  // per fragment: eight bits across each of x, y and z
#endif

void main() {
  uint index;
  if (!takenFragment(index)) return;
  VoxelFragment fragment = fragments[index];
  ivec3 voxel = unpackVoxel(fragment.voxel);
  uint place = sumsAt(voxel);
  float coverage = clamp(unpackHalf2x16(fragment.albedoBCoverage).y, 0.0, 1.0);
  float brightest = uintBitsToFloat(directions[place].brightest);
  float part = 1.0 / float(max(directions[place].fragments, 1u));
  vec3 normal = unpackNormal(fragment.normal), cosines = abs(normal);
  float most = max(cosines.x, max(cosines.y, cosines.z));
  for (int axis = 0; axis < 3; ++axis) {
    float opacity = alongAll != 0 ? coverage : coverage * cosines[axis] / most;
#if SAMPLED
    // The sum is in multiples of 256, so that it leaves the lowest eight bits to the samples.
    atomicAdd(directions[place].opacity[axis], uint(opacity * part * kSampledFixedPoint + 0.5) << kSideSamples);
    atomicOr(directions[place].opacity[axis], sideMasksOf[index] >> kSideSamples * uint(axis) & kAllSides);
#else
    if (coverageSum != 0) {
      atomicAdd(directions[place].opacity[axis], shareOf(opacity * part));
    } else {
      atomicMax(directions[place].opacity[axis], floatBitsToUint(opacity));
    }
#endif
    for (int side = 0; side < 2; ++side) {
      bool towardsHigher = (normal[axis] > 0.0) == (side == 0);
      float weight = coverage * part * cosines[axis] * (side == 0 ? 1.0 : backWeight);
      uvec4 addend = shareOf(partOf(radianceAt(6 * index + 3 * uint(side)), brightest, weight));
      int first = 4 * (2 * axis + (towardsHigher ? 0 : 1));
      for (int channel = 0; channel < 4; ++channel)
        if (addend[channel] != 0u) atomicAdd(directions[place].faces[first + channel], addend[channel]);
    }
  }
}
#else
layout(std430, binding = 4) buffer Sums { VoxelSums sums[]; };

void main() {
  uint index;
  if (!takenFragment(index)) return;
  VoxelFragment fragment = fragments[index];
  ivec3 voxel = unpackVoxel(fragment.voxel);
  uint place = sumsAt(voxel);
  float coverage = clamp(unpackHalf2x16(fragment.albedoBCoverage).y, 0.0, 1.0);
  float weight = coverage * (1.0 / float(max(sums[place].fragments, 1u)));
  uvec4 addend = shareOf(partOf(radianceAt(3 * index), uintBitsToFloat(sums[place].brightest), weight));
  if (addend.r != 0u) atomicAdd(sums[place].red, addend.r);
  if (addend.g != 0u) atomicAdd(sums[place].green, addend.g);
  if (addend.b != 0u) atomicAdd(sums[place].blue, addend.b);
  atomicAdd(sums[place].coverage, addend.a);
}
#endif
