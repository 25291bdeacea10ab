// The surface within a voxel: up to two planes. The surface of a plane is its part behind the other one. Lengths are in voxels, offsets from
// the voxel's centre along the normal.
// Made by shaders/near_field_voxels/planes_resolve.comp. Included after common/bit_grid.glsl with PLANES 1, it also tells that file's walks
// where a ray ends in an occupied voxel. C++ side: RayStop in techniques/near_field_voxels/planes.h.
#ifndef LUMIVOX_VOXEL_PLANES
#define LUMIVOX_VOXEL_PLANES

struct SurfacePlane {
  vec3 normal;   // unit
  float offset;
  bool turned;   // the surface faces away from the normal
};

// A plane in a word: octahedral normal (Cigolle et al. 2014), two numbers of 11 bits; 9 bits of offset, from 1 on; `turned`. 0: no plane.
const float kNormalSteps = 1023.0, kOffsetSteps = 255.0, kLargestOffset = 0.875;  // a voxel's half diagonal is 0.866

uint packPlane(SurfacePlane plane) {
  vec3 normal = plane.normal;
  vec2 p = normal.xy / (abs(normal.x) + abs(normal.y) + abs(normal.z));
  if (normal.z < 0.0) p = (1.0 - abs(p.yx)) * vec2(p.x >= 0.0 ? 1.0 : -1.0, p.y >= 0.0 ? 1.0 : -1.0);
  uvec2 steps = uvec2(ivec2(roundEven(clamp(p, -1.0, 1.0) * kNormalSteps)) + int(kNormalSteps));
  int along = int(roundEven(clamp(plane.offset / kLargestOffset, -1.0, 1.0) * kOffsetSteps)) + int(kOffsetSteps) + 1;
  return steps.x | steps.y << 11 | uint(along) << 22 | (plane.turned ? 0x80000000u : 0u);
}

SurfacePlane unpackPlane(uint word) {
  vec2 p = vec2(ivec2(word & 2047u, word >> 11 & 2047u) - int(kNormalSteps)) / kNormalSteps;
  vec3 normal = vec3(p, 1.0 - abs(p.x) - abs(p.y));
  if (normal.z < 0.0) normal.xy = (1.0 - abs(normal.yx)) * vec2(normal.x >= 0.0 ? 1.0 : -1.0, normal.y >= 0.0 ? 1.0 : -1.0);
  float offset = float(int(word >> 22 & 511u) - int(kOffsetSteps) - 1) * (kLargestOffset / kOffsetSteps);
  return SurfacePlane(normalize(normal), offset, word >> 31 != 0u);
}

#ifdef LUMIVOX_BIT_GRID
layout(std430, binding = 10) readonly buffer VoxelPlanes { uvec2 voxelPlanes[]; };
layout(binding = 14) uniform usampler3D planeSlots;  // of a voxel its slot from 1 on; 0: it has no planes

// Planes of neighbouring voxels do not join exactly where a surface is curved, nor do the two of an edge after packing, voxels.
const float kPlaneSlack = 1.0 / 16.0;

// A ray from a surface meets no back of a surface so near its start, voxels: where a voxel holds two steps of a wall, or a curved surface,
// it may begin behind the mean plane.
const float kNoBacks = 0.5;

// Where the ray meets a plane, between two t, on the side behind the other plane; kNever: nowhere.
float meetsPlane(SurfacePlane plane, bool clipped, SurfacePlane other, vec3 fromCentre, float from, float to) {
  float slope = dot(plane.normal, bitDirection);
  if (slope == 0.0) return kNever;
  float t = (plane.offset - dot(plane.normal, fromCentre)) / slope;
  if (!(t >= from && t <= to)) return kNever;
  if (t < kNoBacks && (slope > 0.0) != plane.turned) return kNever;
  return clipped && dot(other.normal, fromCentre + t * bitDirection) > other.offset + kPlaneSlack ? kNever : t;
}

// The t at which the ray that is followed ends in an occupied voxel; kNever: it passes. In a voxel without planes it ends at the box.
float stopIn(ivec3 voxel, float enters) {
  uint slot = texelFetch(planeSlots, voxel, 0).r;
  if (slot == 0u || slot > uint(voxelPlanes.length())) return enters;
  uvec2 words = voxelPlanes[slot - 1u];
  vec3 fromCentre = bitOrigin - (vec3(voxel) + 0.5);
  float from = max(enters - kPlaneSlack, 0.0), to = leavesVoxel(voxel) + kPlaneSlack;
  SurfacePlane first = unpackPlane(words.x), second = unpackPlane(words.y);
  bool two = words.y != 0u;
  float t = meetsPlane(first, two, second, fromCentre, from, to);
  return two ? min(t, meetsPlane(second, true, first, fromCentre, from, to)) : t;
}

#endif

#endif
