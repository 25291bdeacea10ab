// Means that do not depend on the order in which threads add their items: each item adds its share of the mean as an integer, and integer
// sums are the same in any order (Crassin & Green 2012, Sec. 22.4, but exact):
//   sum over items of round(value * weight * unit),  |value| <= 1 and weights that sum to 1, so that the sum fits into 32 bits.
// Larger values are divided by a range first. A range per voxel is best: a dark voxel beside a very bright one then keeps its light.
#ifndef LUMIVOX_INTEGER_MEAN
#define LUMIVOX_INTEGER_MEAN

const float kFixedPoint = 2147483648.0;        // 2^31: unit of non-negative values
const float kSignedFixedPoint = 1073741824.0;  // 2^30: unit of signed values

uint shareOf(float weighted) { return uint(weighted * kFixedPoint + 0.5); }
uvec4 shareOf(vec4 weighted) { return uvec4(weighted * kFixedPoint + 0.5); }
int signedShareOf(float weighted) { return int(round(weighted * kSignedFixedPoint)); }
ivec4 signedShareOf(vec4 weighted) { return ivec4(round(weighted * kSignedFixedPoint)); }

vec3 meanOf(uint x, uint y, uint z) { return vec3(x, y, z) / kFixedPoint; }
vec4 meanOf(uvec4 sums) { return vec4(sums) / kFixedPoint; }
vec3 signedMeanOf(int x, int y, int z) { return vec3(x, y, z) / kSignedFixedPoint; }

#endif
