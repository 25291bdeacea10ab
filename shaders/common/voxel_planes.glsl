// The surface within a voxel: up to two planes. The surface of a plane is its part behind the other one. Lengths are in voxels, offsets from
// the voxel's centre along the normal.
// Made by shaders/toolkit/planes_resolve.comp. Included after common/bit_grid.glsl with PLANES 1, it also tells that file's walks
// where a ray ends in an occupied voxel. C++ side: RayStop in framework/include/lumivox/toolkit/ray_stop.h.
#ifndef LUMIVOX_VOXEL_PLANES
#define LUMIVOX_VOXEL_PLANES

// A plane in a word: 11 bits each for two coordinates of its normal in octahedral form (Cigolle et al. 2014), 9 bits from 1 on for its
// offset over the normal's sum of absolute components, which is at most 1/2 in a voxel, and one bit: the surface faces against the normal.
// 0: no plane.
const float kNormalSteps = 1023.0, kOffsetSteps = 510.0;

uint packPlane(vec3 normal, float offset, bool turned) {
  float sum = abs(normal.x) + abs(normal.y) + abs(normal.z);
  vec2 p = normal.xy / sum;
  if (normal.z < 0.0) p = (1.0 - abs(p.yx)) * vec2(p.x >= 0.0 ? 1.0 : -1.0, p.y >= 0.0 ? 1.0 : -1.0);
  uvec2 steps = uvec2(ivec2(roundEven(clamp(p, -1.0, 1.0) * kNormalSteps)) + int(kNormalSteps));
  uint along = uint(roundEven((clamp(offset / sum, -0.5, 0.5) + 0.5) * kOffsetSteps)) + 1u;
  return steps.x | steps.y << 11 | along << 22 | (turned ? 0x80000000u : 0u);
}

// xyz: the normal, with 1 as the sum of its absolute components; w: the offset by that measure.
vec4 unpackPlane(uint word) {
  vec2 p = vec2(uvec2(word, word >> 11) & 2047u) / kNormalSteps - 1.0;
  float z = 1.0 - abs(p.x) - abs(p.y);
  if (z < 0.0) p = (1.0 - abs(p.yx)) * vec2(p.x >= 0.0 ? 1.0 : -1.0, p.y >= 0.0 ? 1.0 : -1.0);
  return vec4(p, z, (float(word >> 22 & 511u) - 1.0) / kOffsetSteps - 0.5);
}

#ifdef LUMIVOX_BIT_GRID
layout(std430, binding = 10) readonly buffer VoxelPlanes { uvec2 voxelPlanes[]; };
layout(binding = 14) uniform usampler3D planeSlots;  // of a voxel its slot from 1 on; 0: it has no planes

// Planes of neighbouring voxels do not join exactly where a surface is curved, nor do the two of an edge after packing, voxels.
const float kPlaneSlack = 1.0 / 16.0;

// A ray from a surface meets no back of a surface so near its start, voxels: where a voxel holds two steps of a wall, or a curved surface,
// it may begin behind the mean plane.
const float kNoBacks = 0.5;

// Where the ray meets a plane within the voxel and behind the other plane, if there is one; kNever: nowhere.
float meetsPlane(uint word, vec4 plane, bool clipped, vec4 other, vec3 fromCentre) {
  float slope = dot(plane.xyz, bitDirection), t = (plane.w - dot(plane.xyz, fromCentre)) / slope;
  vec3 place = fromCentre + t * bitDirection;
  // Written so that a ray along the plane, whose t is none, meets it nowhere.
  bool meets = t >= 0.0 && all(lessThanEqual(abs(place), vec3(0.5 + kPlaneSlack)));
  if (clipped) meets = meets && dot(other.xyz, place) <= other.w + kPlaneSlack;
  return meets && (t >= kNoBacks || (slope > 0.0) == (word >> 31 != 0u)) ? t : kNever;
}

// Of a voxel its slot from 1 on; 0: it has no planes, and rays end at its box.
uint slotOfPlanes(ivec3 voxel) {
  uint slot = texelFetch(planeSlots, voxel, 0).r;
  return slot <= uint(voxelPlanes.length()) ? slot : 0u;
}

// Where the ray that is followed meets a plane of a voxel with a slot: the normal in xyz, of any length, and the t in w; kNever: it passes.
vec4 planeMetIn(ivec3 voxel, uint slot) {
  uvec2 words = voxelPlanes[slot - 1u];
  vec3 fromCentre = bitOrigin - (vec3(voxel) + 0.5);
  vec4 first = unpackPlane(words.x);
  if (words.y == 0u) return vec4(first.xyz, meetsPlane(words.x, first, false, first, fromCentre));
  vec4 second = unpackPlane(words.y);
  float atFirst = meetsPlane(words.x, first, true, second, fromCentre), atSecond = meetsPlane(words.y, second, true, first, fromCentre);
  return atSecond < atFirst ? vec4(second.xyz, atSecond) : vec4(first.xyz, atFirst);
}

// The t at which the ray ends in an occupied voxel that it enters at a t; kNever: it passes.
float stopIn(ivec3 voxel, float enters) {
  uint slot = slotOfPlanes(voxel);
  return slot == 0u ? enters : planeMetIn(voxel, slot).w;
}

// The unit normal of the plane at which the ray ended in a voxel, on the side that the ray came from; zero: it ended at the box.
vec3 normalOfStop(ivec3 voxel) {
  uint slot = slotOfPlanes(voxel);
  if (slot == 0u) return vec3(0.0);
  vec3 normal = normalize(planeMetIn(voxel, slot).xyz);
  return dot(normal, bitDirection) > 0.0 ? -normal : normal;
}

#endif

#endif
