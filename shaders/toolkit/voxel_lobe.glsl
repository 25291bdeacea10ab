// The lobe of a voxel's spherical harmonics: the surface |p| = s max(0, f(p / |p|)) around the voxel's centre. f is their luminance; s is
// chosen so that the lobe reaches the nearest side of the voxel.
#ifndef LUMIVOX_VOXEL_LOBE
#define LUMIVOX_VOXEL_LOBE
#include "common/spherical_harmonics.glsl"
#include "toolkit/voxel_walk.glsl"

// Whether a ray hits the lobe of the voxel that it crosses. `seen`: rgb the harmonics in the direction of the first hit point, a its
// brightness. Lobes whose largest value is at most `above` are skipped.
bool meetsLobe(VoxelWalk walk, vec3 eye, vec3 direction, float above, out vec4 seen) {
  const vec3 kLuminance = vec3(0.2126, 0.7152, 0.0722);  // Rec. 709
  const int kSteps = 32, kHalvings = 12;
  seen = vec4(0.0);
  vec4 harmonics[3];
  vec4 shape = vec4(0.0);
  for (int c = 0; c < 3; ++c) {
    harmonics[c] = texelOf(textureOf[c], walk.voxel) * fieldUnit;
    shape += kLuminance[c] * harmonics[c];
  }
  float mean = kY0 * shape.x;
  vec3 slope = kY1 * shape.wyz;
  float most = mean + length(slope);
  if (!(most > above)) return false;
  float reach = 0.5 * shortestSide(), scale = reach / most;
  // The sphere around the lobe.
  vec3 offset = eye - (gridLow + (vec3(walk.voxel) + 0.5) * voxelSides);
  float along = -dot(offset, direction), apart = dot(offset, offset) - along * along;
  if (apart >= reach * reach) return false;
  float chord = sqrt(reach * reach - apart), from = max(walk.from, along - chord), to = min(walk.to, along + chord);
  if (from >= to) return false;
  // p is inside the lobe if |p|^2 <= scale (mean |p| + slope . p).
  float before = from, at = from;
  bool met = false;
  for (int i = 0; i <= kSteps && !met; ++i) {
    before = at;
    at = mix(from, to, float(i) / float(kSteps));
    vec3 p = offset + at * direction;
    met = dot(p, p) <= scale * (mean * length(p) + dot(slope, p));
  }
  if (!met) return false;
  for (int i = 0; i < kHalvings; ++i) {
    float middle = 0.5 * (before + at);
    vec3 p = offset + middle * direction;
    if (dot(p, p) <= scale * (mean * length(p) + dot(slope, p))) at = middle;
    else before = middle;
  }
  vec3 p = offset + at * direction;
  float distance = max(length(p), 1e-20);
  vec4 basis = shBasis(p / distance);
  vec3 normal = 2.0 * p - scale * (mean * p / distance + slope);
  seen.rgb = vec3(dot(harmonics[0], basis), dot(harmonics[1], basis), dot(harmonics[2], basis));
  seen.a = 0.4 + 0.6 * clamp(-dot(normal, direction) / max(length(normal), 1e-20), 0.0, 1.0);
  return true;
}

#endif
