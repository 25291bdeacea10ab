#version 450
// One more bounce: cones gather light at the listed fragments from the store of the previous bounces; it is reflected diffusely (Crassin et
// al. 2011 inject direct light only). Like inject.comp, it counts the fragments of each voxel.
//
// DIRECTIONS: both sides gather separately. Otherwise a voxel emits equally to all sides, and the side that reflects more counts.
#pragma lumivox axis DIRECTIONS 0 1
#pragma lumivox require (STORE == directional || STORE == clipmap || FACES == six) == (DIRECTIONS == 1)
#pragma lumivox require !CHANGED && (PLACES == octree) == (STORE == octree) && (PLACES == clipmap) == (STORE == clipmap)
layout(local_size_x = 64) in;
#include "store.glsl"
#include "common/cone_march.glsl"
#include "common/brdf.glsl"
#include "common/fragments.glsl"
#include "../bricks.glsl"

layout(std140, binding = 0) uniform Parameters {
  vec3 gridLow;        // m
  float voxelSize;     // m
  ivec3 brickCount;
  int coneCount;
  float mostRadiance;  // W/(sr m^2): limit of the radiance of a voxel
  int twoSided;        // 1: light on the back side counts as well
  int glossy;          // 1: Phong lobes reflect to all sides like diffuse light
};
layout(std430, binding = 2) readonly buffer ListedFragments { uint listedFragments[]; };
layout(std430, binding = 7) writeonly buffer Radiances { float radiances[]; };  // r, g, b per fragment or per side of a fragment, W/(sr m^2)
layout(std430, binding = 3) readonly buffer Bricks { Brick bricks[]; };
#include "../sums.glsl"
#if DIRECTIONS
layout(std430, binding = 4) buffer DirectionalSums { VoxelDirections directions[]; };
#else
layout(std430, binding = 4) buffer Sums { VoxelSums sums[]; };
#endif

// The low corner of a voxel, and its size, m.
#if PLACES == PLACES_CLIPMAP
#include "../clipmap/clipmap_stack.glsl"
vec4 placeOfVoxel(ivec3 voxel) {
  int level = levelInStack(voxel);
  return vec4(stackOrigin + vec3(voxelOfLevel(voxel, level)) * voxelSizeOf(level), voxelSizeOf(level));
}
#else
vec4 placeOfVoxel(ivec3 voxel) { return vec4(gridLow + vec3(voxel) * voxelSize, voxelSize); }
#endif

// Cosine-weighted mean of the arriving radiance. `place` shifts the cones; it depends only on the fragment.
vec3 arrivingFrom(vec3 posWorld, vec3 normal, float size, vec2 place) {
  vec3 apex = posWorld + normal * (offset * size), tangent = tangentTo(normal), bitangent = cross(normal, tangent), sum = vec3(0.0);
  for (int i = 0; i < coneCount; ++i) {
    float cosTheta, tanHalfAngle;
    vec3 direction = cosineCone(i, coneCount, place, tangent, bitangent, normal, cosTheta, tanHalfAngle);
    sum += traceCone(apex, direction, tanHalfAngle, cosTheta, uint(i));
  }
  return sum / float(coneCount);
}

float total(vec3 value) { return value.r + value.g + value.b; }

void main() {
  if (listIndex() >= fragmentCount) return;
  uint index = listedFragments[listIndex()];
  VoxelFragment fragment = fragments[index];
  ivec3 voxel = unpackVoxel(fragment.voxel);
  vec4 lowSize = placeOfVoxel(voxel);
  vec3 posWorld = lowSize.xyz + unpackOffset(fragment.offset) * lowSize.w, normal = unpackNormal(fragment.normal);
  vec3 albedo = vec3(unpackHalf2x16(fragment.albedoRg), unpackHalf2x16(fragment.albedoBCoverage).x);
  vec4 lobe = glossy != 0 ? lobeOf(fragment) : vec4(0.0);
  if (any(greaterThan(lobe.rgb, vec3(0.0)))) albedo += lobe.rgb * phongAlbedo(lobe.w);
  vec2 place = unitInterval(hash4(uvec4(fragment.voxel, fragment.offset, fragment.normal, 0u)).xy);
  vec3 sides[2] = vec3[2](vec3(0.0), vec3(0.0));  // front, back
  // One call for both sides: the march is inlined at every call.
  for (int side = 0; side <= min(twoSided, 1); ++side)
    sides[side] = albedo * arrivingFrom(posWorld, side == 0 ? normal : -normal, lowSize.w, place);
#if DIRECTIONS
  const uint kSides = 2u;
#else
  if (total(sides[0]) < total(sides[1])) sides[0] = sides[1];
  const uint kSides = 1u;
#endif
  float brightest = 0.0;
  for (uint side = 0u; side < kSides; ++side) {
    uint first = 3u * (kSides * index + side);
    for (int channel = 0; channel < 3; ++channel) {
      float radiance = min(sides[side][channel], mostRadiance);
      radiances[first + uint(channel)] = radiance;
      brightest = max(brightest, radiance);
    }
  }
  uint sum = sumsAt(voxel);
#if DIRECTIONS
  atomicAdd(directions[sum].fragments, 1u);
  atomicMax(directions[sum].brightest, floatBitsToUint(brightest));
#else
  atomicAdd(sums[sum].fragments, 1u);
  atomicMax(sums[sum].brightest, floatBitsToUint(brightest));
#endif
}
