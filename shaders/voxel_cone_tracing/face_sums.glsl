// A face of a voxel from the sums over its fragments: radiance pre-multiplied by opacity, and opacity. add.comp says what they hold.
// Including files declare `directions` before.
#ifndef LUMIVOX_FACE_SUMS
#define LUMIVOX_FACE_SUMS
#include "bricks.glsl"
#include "common/integer_mean.glsl"

// What the fragments send to the side of a face, where they cover this share of it, in units of `unit`.
vec3 radianceOfFace(uint place, int face, float covered, float unit) {
  uint weight = directions[place].faces[4 * face + 3];
  if (weight == 0u) return vec3(0.0);
  vec3 sum = vec3(directions[place].faces[4 * face], directions[place].faces[4 * face + 1], directions[place].faces[4 * face + 2]);
  return sum / float(weight) * (covered * uintBitsToFloat(directions[place].brightest) / unit);
}

// `addsUp`: the coverages of the fragments add up, to 1 at most; else the largest counts.
vec4 faceOf(uint place, int face, bool addsUp, float unit) {
  uint sum = directions[place].opacity[face / 2];
  float opacity = min(addsUp ? float(sum) / kFixedPoint * float(directions[place].fragments) : uintBitsToFloat(sum), 1.0);
  return vec4(radianceOfFace(place, face, opacity, unit), opacity);
}

// By samples of the voxel's sides: radiance by the share that the fragments cover; opacity by the samples, which are few, and never less than
// that share, or what little a small thing covers would not be seen.
vec4 faceOfSamples(uint place, int face, float unit) {
  uint sum = directions[place].opacity[face / 2];
  float covered = min(float(sum >> kSideSamples) / kSampledFixedPoint * float(directions[place].fragments), 1.0);
  float opacity = max(float(bitCount(sum & kAllSides)) / float(kSideSamples), covered);
  return vec4(radianceOfFace(place, face, covered, unit), opacity);
}

#endif
