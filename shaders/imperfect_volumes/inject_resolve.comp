#version 450
// The means of each occupied voxel as spherical harmonics of its outgoing radiance (Mavridis & Papaioannou 2011, Sec. 3.1 and Eq. 1). A
// side with a uniform radiance L over its half space has the coefficients L (2 pi Y0, pi Y1 n). A side with the same exitance whose
// radiance falls with the cosine, 3/2 L cos, has 3/2 L (pi Y0, 2/3 pi Y1 n): the second band is the same.
#pragma lumivox axis PRECISION float half
#include "common/spherical_harmonics.glsl"
layout(local_size_x = 64) in;
#include "volume_sums.glsl"
#include "toolkit/slots.glsl"

layout(constant_id = 0) const int cosineLobe = 0;

layout(std140, binding = 0) uniform Resolving { float unit; };  // radiance of the number 1, W/(sr m^2)
layout(std430, binding = 6) readonly buffer Brightest { uint brightest[]; };
#if PRECISION == PRECISION_HALF
layout(binding = 0, rgba16f) uniform writeonly image3D redImage;
layout(binding = 1, rgba16f) uniform writeonly image3D greenImage;
layout(binding = 2, rgba16f) uniform writeonly image3D blueImage;
#else
layout(binding = 0, rgba32f) uniform writeonly image3D redImage;
layout(binding = 1, rgba32f) uniform writeonly image3D greenImage;
layout(binding = 2, rgba32f) uniform writeonly image3D blueImage;
#endif

vec4 coefficientsOf(uint slot, int channel, float scale) {
  float both = 2.0 * float(sums[slot].both[channel]) / kFixedPoint;
  vec3 difference = signedMeanOf(sums[slot].difference[3 * channel], sums[slot].difference[3 * channel + 1],
                                 sums[slot].difference[3 * channel + 2]);
  return scale * vec4((cosineLobe != 0 ? 1.5 : 2.0) * kPi * kY0 * both, kPi * kY1 * difference.yzx);
}

void main() {
  uint slot;
  ivec3 voxel;
  if (!slotHere(slot, voxel)) return;
  // If all coverages are 0 there is no average.
  float scale = sums[slot].coverage > 0u ? kFixedPoint / float(sums[slot].coverage) * uintBitsToFloat(brightest[slot]) / unit : 0.0;
  imageStore(redImage, voxel, coefficientsOf(slot, 0, scale));
  imageStore(greenImage, voxel, coefficientsOf(slot, 1, scale));
  imageStore(blueImage, voxel, coefficientsOf(slot, 2, scale));
}
