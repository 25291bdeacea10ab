#version 450
// Each fragment adds its normal and its place to one of the two groups of its voxel.
layout(local_size_x = 64) in;
#include "planes.glsl"
#include "planes_sums.glsl"
layout(std430, binding = 6) buffer PlaneSums { PlaneSum planeSums[]; };

void main() {
  uint index = listIndex();
  if (index >= fragmentCount) return;
  VoxelFragment fragment = fragments[index];
  uint slot;
  if (!slotOf(unpackVoxel(fragment.voxel), slot)) return;
  vec3 normal = unpackNormal(fragment.normal);
  uint second = planeKeys[2u * slot + 1u];
  vec2 agreement = vec2(dot(normal, unpackNormal(planeKeys[2u * slot])), second != 0u ? dot(normal, secondNormal(second)) : 0.0);
  // About one of both normals; else against one of both, where a thin wall ends and its two sides make one plane.
  bool about = max(agreement.x, agreement.y) >= kTogether;
  vec2 closeness = about ? agreement : abs(agreement);
  int group = closeness.x >= closeness.y ? 0 : 1;
  if (agreement[group] < 0.0) normal = -normal;
  vec3 place = unpackOffset(fragment.offset & (kSeenBehind - 1u)) - 0.5;
  float share = 1.0 / float(fragmentsOfSlot[slot]);
  uint sum = 2u * slot + uint(group);
  for (int c = 0; c < 3; ++c) {
    atomicAdd(planeSums[sum].normal[c], signedShareOf(normal[c] * share));
    atomicAdd(planeSums[sum].place[c], signedShareOf(place[c] * share));
  }
  atomicAdd(planeSums[sum].share, signedShareOf(share));
}
