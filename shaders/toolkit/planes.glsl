// Two groups of the fragments of each occupied voxel, by their normals, for the planes through them.
#include "toolkit/slot_of_voxel.glsl"

// Fragments belong together whose normals differ by at most 45 degrees.
const float kTogether = 0.70710678;

layout(std430, binding = 5) buffer PlaneKeys { uint planeKeys[]; };  // two words a slot: normals that the groups are about; 0: none

// The largest packed normal of the voxel is the first: the same in any order of the fragments.
uint firstKeyOf(VoxelFragment fragment) { return max(fragment.normal, 1u); }

// Of the fragments beside those about the first key. Normals across it come before those against it, where a thin wall ends.
uint secondKeyOf(VoxelFragment fragment, uint firstKey) {
  float agreement = dot(unpackNormal(fragment.normal), unpackNormal(firstKey));
  if (agreement >= kTogether) return 0u;
  return max(fragment.normal >> 1, 1u) | (agreement > -kTogether ? 0x80000000u : 0u);
}
vec3 secondNormal(uint key) { return unpackNormal(key << 1); }
