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
  vec2 p = (vec2(uvec2(word, word >> 11) & 2047u) - kNormalSteps) * (1.0 / kNormalSteps);
  float z = 1.0 - abs(p.x) - abs(p.y);
  if (z < 0.0) p = (1.0 - abs(p.yx)) * vec2(p.x >= 0.0 ? 1.0 : -1.0, p.y >= 0.0 ? 1.0 : -1.0);
  return vec4(p, z, (float(word >> 22 & 511u) - (0.5 * kOffsetSteps + 1.0)) * (1.0 / kOffsetSteps));
}

// A texel of planesOfVoxels: the word of a voxel's only plane, which faces along its normal, so that the highest bit is free; or this bit and
// the place of both words in voxelPlanes; or 0 where rays end at the voxel's box. Most voxels have one plane, which then takes one fetch.
const uint kTwoPlanes = 0x80000000u;

#ifdef LUMIVOX_BIT_GRID
layout(std430, binding = 10) readonly buffer VoxelPlanes { uvec2 voxelPlanes[]; };
layout(binding = 14) uniform usampler3D planesOfVoxels;

// Planes of neighbouring voxels do not join exactly where a surface is curved, nor do the two of an edge after packing, voxels.
const float kPlaneSlack = 1.0 / 16.0;

// A ray from a surface meets no back of a surface so near its start, voxels: where a voxel holds two steps of a wall, or a curved surface,
// it may begin behind the mean plane.
const float kNoBacks = 0.5;

// A plane seen from the ray that is followed.
struct PlaneAlong {
  float slope;  // of the ray along the normal
  float ahead;  // along the normal, from the ray's start to the plane
};
PlaneAlong alongRay(vec4 plane, vec3 fromCentre) {
  return PlaneAlong(dot(plane.xyz, bitDirection), plane.w - dot(plane.xyz, fromCentre));
}

// Whether the ray meets the plane of a word at a t within the voxel. Written so that a ray along the plane, whose t is none, meets it nowhere.
bool meetsWithin(uint word, float slope, float t, vec3 fromCentre) {
  return t >= 0.0 && all(lessThanEqual(abs(fromCentre + t * bitDirection), vec3(0.5 + kPlaneSlack))) &&
         (t >= kNoBacks || (slope > 0.0) == (word >> 31 != 0u));
}

// The texel of a voxel; 0: it has no planes, and rays end at its box.
uint planesOf(ivec3 voxel) { return texelFetch(planesOfVoxels, voxel, 0).r; }

// Where the ray that is followed meets a plane of a voxel with this texel: the normal in xyz, of any length, and the t in w; kNever: it
// passes.
vec4 planeMetIn(ivec3 voxel, uint texel) {
  vec3 fromCentre = bitOrigin - (vec3(voxel) + 0.5);
  bool two = texel >= kTwoPlanes;
  uvec2 words = two ? voxelPlanes[texel & ~kTwoPlanes] : uvec2(texel, 0u);
  vec4 first = unpackPlane(words.x);
  PlaneAlong a = alongRay(first, fromCentre);
  float t = a.ahead / a.slope;
  bool meets = meetsWithin(words.x, a.slope, t, fromCentre);
  if (!two) return vec4(first.xyz, meets ? t : kNever);
  // The surface of each plane is its part behind the other.
  vec4 second = unpackPlane(words.y);
  PlaneAlong b = alongRay(second, fromCentre);
  float other = b.ahead / b.slope;
  if (!(meets && t * b.slope <= b.ahead + kPlaneSlack)) t = kNever;
  if (!(meetsWithin(words.y, b.slope, other, fromCentre) && other * a.slope <= a.ahead + kPlaneSlack)) other = kNever;
  return other < t ? vec4(second.xyz, other) : vec4(first.xyz, t);
}

// The t at which the ray ends in an occupied voxel that it enters at a t; kNever: it passes.
float stopIn(ivec3 voxel, float enters) {
  uint texel = planesOf(voxel);
  return texel == 0u ? enters : planeMetIn(voxel, texel).w;
}

// The unit normal of the plane at which the ray ended in a voxel, on the side that the ray came from; zero: it ended at the box.
vec3 normalOfStop(ivec3 voxel) {
  uint texel = planesOf(voxel);
  if (texel == 0u) return vec3(0.0);
  vec3 normal = normalize(planeMetIn(voxel, texel).xyz);
  return dot(normal, bitDirection) > 0.0 ? -normal : normal;
}

#endif

#endif
