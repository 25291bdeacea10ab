// Cones through pre-filtered voxels (Crassin et al. 2011): their axes and widths, the mip levels that they read, the opacity of a step, and
// the composite of opacities. Radiance is pre-multiplied by opacity throughout.
#ifndef LUMIVOX_CONES
#define LUMIVOX_CONES
#include "common/constants.glsl"

const float kOpaque = 0.999;  // surfaces behind this opacity contribute less than a thousandth

// The colour and opacity of `back` seen through `front`.
vec4 over(vec4 front, vec4 back) { return front + (1.0 - front.a) * back; }

// Radius of a cone over its height.
float tanOfHalfAngle(float cosHalfAngle) { return sqrt(max(1.0 - cosHalfAngle * cosHalfAngle, 0.0)) / cosHalfAngle; }

// For a cone with the solid angle of the lobe cos^n: 2 pi / (n + 1) = 2 pi (1 - cos(half angle)). The half angle is at most 60 degrees.
float cosHalfAngleOfLobe(float exponent) { return max(1.0 - 1.0 / (exponent + 1.0), 0.5); }

// A unit vector perpendicular to another.
vec3 tangentTo(vec3 normal) {
  vec3 helper = abs(normal.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0);
  return normalize(cross(helper, normal));
}

// Cones of equal weight: a spiral over the unit disc, lifted onto the hemisphere (Malley's method), is cosine-distributed. Each cone
// represents the solid angle pi / (n cos theta), and has the half angle of a circular cone of this solid angle. cosTheta is the cosine
// between axis and normal. `place` is the position of the axis in its stratum of the disc: x along the square of the radius, 0.5 in the
// middle; y around, a fraction of a turn.
vec3 cosineCone(int i, int count, vec2 place, vec3 tangent, vec3 bitangent, vec3 normal, out float cosTheta, out float tanHalfAngle) {
  float radiusSquared = (float(i) + place.x) / float(count);
  float radius = sqrt(radiusSquared), angle = float(i) * kGoldenAngle + place.y * 2.0 * kPi;
  cosTheta = sqrt(1.0 - radiusSquared);
  tanHalfAngle = tanOfHalfAngle(max(1.0 - 0.5 / (float(count) * cosTheta), 0.5));
  return tangent * (radius * cos(angle)) + bitangent * (radius * sin(angle)) + normal * cosTheta;
}

// Distances along a ray, m, at which it enters and leaves a box; for a ray that misses the box, the second is less than the first.
vec2 insideVolume(vec3 low, vec3 extent, vec3 origin, vec3 direction) {
  const vec3 kLevel = vec3(1e-12);  // avoids division by 0; the motion along the axis stays negligible
  vec3 slope = mix(direction, kLevel, lessThan(abs(direction), kLevel));
  vec3 toLow = (low - origin) / slope, toHigh = (low + extent - origin) / slope;
  vec3 near = min(toLow, toHigh), far = max(toLow, toHigh);
  return vec2(max(near.x, max(near.y, near.z)), min(far.x, min(far.y, far.z)));
}

// The mip level l for voxels of `size` finest voxels, at least 1, and the weight of level l+1: `blend` is size / 2^l - 1.
float levelOf(float size, float coarsest, out float blend) {
  // log2 and exp2 are not exact (GLSL 4.50, Sec. 4.7.1): the blend is clamped.
  float level = clamp(floor(log2(size)), 0.0, coarsest);
  blend = level < coarsest ? clamp(size * exp2(-level) - 1.0, 0.0, 1.0) : 0.0;
  return level;
}

// Transmittance T of one voxel of the finer of two levels, from the blend of both: a uniform medium gives (1-f) T + f T^2, solved for T.
float throughVoxel(float through, float blend) {
  return 2.0 * through / max(1.0 - blend + sqrt((1.0 - blend) * (1.0 - blend) + 4.0 * blend * through), 1e-30);
}

// Opacity correction (Crassin et al. 2011; thesis 004 Sec. 4.2.1). `through` is the transmittance of a known length; `lengths` is the step
// divided by this length.
float stepOpacityOf(float through, float lengths) { return 1.0 - pow(through, lengths); }

#endif
