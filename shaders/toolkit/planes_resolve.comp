#version 450
// The planes of each voxel: the mean normal of a group through its mean place. Each plane faces away from the other group's mean place. At a
// convex edge the solid then lies behind both planes, at a concave one the free space; either way, the surface of a plane ends where the
// other plane cuts it.
layout(local_size_x = 64) in;
#include "common/voxel_planes.glsl"
#include "planes_sums.glsl"
#include "toolkit/slots.glsl"
layout(std430, binding = 6) readonly buffer PlaneSums { PlaneSum planeSums[]; };
layout(std430, binding = 7) writeonly buffer VoxelPlanes { uvec2 voxelPlanes[]; };
layout(binding = 0, r32ui) uniform writeonly uimage3D slots;  // becomes planesOfVoxels of common/voxel_planes.glsl

struct Group {
  bool any;
  vec3 place, normal;
};

Group groupOf(uint slot, uint number) {
  PlaneSum sum = planeSums[2u * slot + number];
  vec3 normal = signedMeanOf(sum.normal[0], sum.normal[1], sum.normal[2]);
  float share = float(sum.share) / kSignedFixedPoint, across = length(normal);
  if (!(share > 0.0 && across > 0.0)) return Group(false, vec3(0.0), vec3(0.0));
  return Group(true, signedMeanOf(sum.place[0], sum.place[1], sum.place[2]) / share, normal / across);
}

uint planeOf(Group group, Group other) {
  if (!group.any) return 0u;
  float offset = dot(group.normal, group.place);
  bool turned = other.any && dot(group.normal, other.place) > offset;
  return turned ? packPlane(-group.normal, -offset, true) : packPlane(group.normal, offset, false);
}

void main() {
  uint slot;
  ivec3 voxel;
  if (!slotHere(slot, voxel)) return;
  Group first = groupOf(slot, 0u), second = groupOf(slot, 1u);
  uvec2 planes = uvec2(planeOf(first, second), planeOf(second, first));
  bool two = planes.x != 0u && planes.y != 0u;
  if (two) voxelPlanes[slot] = planes;
  imageStore(slots, voxel, uvec4(two ? kTwoPlanes | slot : planes.x | planes.y));
}
