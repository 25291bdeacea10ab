#version 450
// Averages an attribute of fragments in the voxels of the leaves, each found by descending from the root (Sec. 4.2.2, Listing 4.23):
// reflected ambient light, colours, or normals as the thesis packs them, n / 2 + 1/2.
layout(local_size_x = 64) in;
#include "common/constants.glsl"
#include "common/fragments.glsl"
#include "octree_levels.glsl"
#include "octree_sums.glsl"

const int kLight = 0, kColour = 1, kNormal = 2;
layout(constant_id = 1) const int what = kLight;

layout(std140, binding = 0) uniform Surfaces { float ambient; };  // irradiance, W/m^2

void main() {
  uint index = listIndex();
  if (index >= fragmentCount) return;
  VoxelFragment fragment = fragments[index];
  ivec3 voxel = unpackVoxel(fragment.voxel), own = voxel & 1;
  uint brick = brickAt(voxel >> 1, octreeDepth);
  if (brick == kNone || octreeLevels[octreeDepth].bricks == 0u) return;  // too little room: the frame is rendered again
  vec2 blueCoverage = unpackHalf2x16(fragment.albedoBCoverage);
  vec3 value = vec3(unpackHalf2x16(fragment.albedoRg), blueCoverage.x);
  if (what == kLight) value = value / kPi * ambient;
  // Listings 4.9 and 4.23 average packed normals without their coverage. Coverage would pull the packed
  // values to 0, a normal of (-1, -1, -1).
  if (what == kNormal) value = clamp(0.5 + 0.5 * unpackNormal(fragment.normal), 0.0, 1.0);
  float coverage = what == kNormal ? 1.0 : clamp(blueCoverage.y, 0.0, 1.0);
  uint place = sumsOf(brick, uint(own.x | own.y << 1 | own.z << 2));
  if (stage == kCount)
    countIn(place, value);
  else
    addTo(place, unitsOf(place, value) * (coverage * (1.0 / float(max(sums[place].items, 1u)))));
}
