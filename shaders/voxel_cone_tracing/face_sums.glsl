// A face of a voxel from the sums over its fragments: radiance pre-multiplied by opacity, and opacity. add.comp describes the sums.
// Including files first declare `directions`.
#ifndef LUMIVOX_FACE_SUMS
#define LUMIVOX_FACE_SUMS
#include "bricks.glsl"
#include "common/integer_mean.glsl"

// Radiance from the fragments towards the side of a face, times the share `covered` of the face that they cover, in units of `unit`.
vec3 radianceOfFace(uint place, int face, float covered, float unit) {
  uint weight = directions[place].faces[4 * face + 3];
  if (weight == 0u) return vec3(0.0);
  vec3 sum = vec3(directions[place].faces[4 * face], directions[place].faces[4 * face + 1], directions[place].faces[4 * face + 2]);
  return sum / float(weight) * (covered * uintBitsToFloat(directions[place].brightest) / unit);
}

// `addsUp`: the opacity is the sum of the fragments' coverages, at most 1; otherwise the largest.
vec4 faceOf(uint place, int face, bool addsUp, float unit) {
  uint sum = directions[place].opacity[face / 2];
  float opacity = min(addsUp ? float(sum) / kFixedPoint * float(directions[place].fragments) : uintBitsToFloat(sum), 1.0);
  return vec4(radianceOfFace(place, face, opacity, unit), opacity);
}

// Mean radiance from the fragments over all sides, in the same units.
vec3 radianceOfVoxel(uint place, float unit) {
  vec3 sum = vec3(0.0);
  float weight = 0.0;
  for (int face = 0; face < 6; ++face) {
    sum += vec3(directions[place].faces[4 * face], directions[place].faces[4 * face + 1], directions[place].faces[4 * face + 2]);
    weight += float(directions[place].faces[4 * face + 3]);
  }
  return weight > 0.0 ? sum / weight * (uintBitsToFloat(directions[place].brightest) / unit) : vec3(0.0);
}

// SAMPLED: the opacity is the share of covered samples of the voxel's side, but at least the share that the fragments cover. The radiance
// uses the latter, which is finer than the few samples. The additional opacity of a thickened surface seen from the side has the mean
// radiance of the voxel (thesis 004 Sec. 3.5.2: emittance goes into all directions). Its share is limited to the largest share that the
// fragments cover of any side, so that the light of small objects does not jump.
vec4 faceOfSamples(uint place, int face, float unit) {
  float covered[3];
  for (int axis = 0; axis < 3; ++axis)
    covered[axis] = min(float(directions[place].opacity[axis] >> kSideSamples) / kSampledFixedPoint * float(directions[place].fragments), 1.0);
  float own = covered[face / 2], most = max(covered[0], max(covered[1], covered[2]));
  float opacity = max(float(bitCount(directions[place].opacity[face / 2] & kAllSides)) / float(kSideSamples), own);
  return vec4(radianceOfFace(place, face, own, unit) + min(opacity - own, most) * radianceOfVoxel(place, unit), opacity);
}

#endif
