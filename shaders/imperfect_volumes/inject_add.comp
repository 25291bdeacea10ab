#version 450
// Each fragment adds its share to the means of its voxel.
layout(local_size_x = 64) in;
#include "volume_sums.glsl"
#include "toolkit/slot_of_voxel.glsl"

layout(std430, binding = 2) readonly buffer Radiances { float radiances[]; };
layout(std430, binding = 6) readonly buffer Brightest { uint brightest[]; };

void main() {
  uint index = listIndex();
  if (index >= fragmentCount) return;
  VoxelFragment fragment = fragments[index];
  uint slot;
  if (!slotOf(unpackVoxel(fragment.voxel), slot)) return;
  float weight = clamp(unpackHalf2x16(fragment.albedoBCoverage).y, 0.0, 1.0) / float(fragmentsOfSlot[slot]);
  atomicAdd(sums[slot].coverage, shareOf(weight));
  float range = uintBitsToFloat(brightest[slot]);
  if (!(range > 0.0)) return;
  vec3 normal = unpackNormal(fragment.normal);
  for (int channel = 0; channel < 3; ++channel) {
    float front = radiances[6 * index + channel] / range, back = radiances[6 * index + 3 + channel] / range;
    atomicAdd(sums[slot].both[channel], shareOf(0.5 * (front + back) * weight));
    for (int axis = 0; axis < 3; ++axis)
      atomicAdd(sums[slot].difference[3 * channel + axis], signedShareOf((front - back) * normal[axis] * weight));
  }
}
