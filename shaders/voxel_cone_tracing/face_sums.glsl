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

// What the fragments send to all sides in the mean, in the same units.
vec3 radianceOfVoxel(uint place, float unit) {
  vec3 sum = vec3(0.0);
  float weight = 0.0;
  for (int face = 0; face < 6; ++face) {
    sum += vec3(directions[place].faces[4 * face], directions[place].faces[4 * face + 1], directions[place].faces[4 * face + 2]);
    weight += float(directions[place].faces[4 * face + 3]);
  }
  return weight > 0.0 ? sum / weight * (uintBitsToFloat(directions[place].brightest) / unit) : vec3(0.0);
}

// By samples of the voxel's sides: opacity by those that are covered, which are few, and never less than the share that the fragments cover;
// radiance by that share, which is finer. What makes a surface thicker than it is seen from the side shines as the whole voxel does (thesis
// 004 Sec. 3.5.2: emittance goes into all directions), but in no larger share than the fragments cover of any side, so that nothing small
// shines by leaps.
vec4 faceOfSamples(uint place, int face, float unit) {
  float covered[3];
  for (int axis = 0; axis < 3; ++axis)
    covered[axis] = min(float(directions[place].opacity[axis] >> kSideSamples) / kSampledFixedPoint * float(directions[place].fragments), 1.0);
  float own = covered[face / 2], most = max(covered[0], max(covered[1], covered[2]));
  float opacity = max(float(bitCount(directions[place].opacity[face / 2] & kAllSides)) / float(kSideSamples), own);
  return vec4(radianceOfFace(place, face, own, unit) + min(opacity - own, most) * radianceOfVoxel(place, unit), opacity);
}

#endif
