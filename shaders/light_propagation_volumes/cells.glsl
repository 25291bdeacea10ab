// Geometry of a cell and its neighbours (Kaplanyan & Dachsbacher 2010, Sec. 4.3; thesis 004 Listing 4.32), in cells.
#include "common/spherical_harmonics.glsl"

// Solid angles of the faces of a neighbour's cube as seen from a cell's centre, sr: the far face, 4 atan(1 / (3 sqrt 11)), and each of the
// four side faces, so that the five sum to a sixth of the sphere.
const float kFarFace = 0.40066968;
const float kSideFace = (2.0 / 3.0 * kPi - kFarFace) / 4.0;
// The centre of a side face lies in the direction (1, 1/2, 0) / |...|.
const float kAlong = 0.89442719099991588;   // 2 / sqrt 5
const float kAcross = 0.44721359549995794;  // 1 / sqrt 5

// The flux that leaves a cell of intensity I(w) = c . Y(w) through one of its faces is the sum over the neighbour's five other faces,
//   solid angle * I(direction of its centre) = kCrossing0 c0 + kCrossing1 c1 . n,  n the normal of the face.
const float kCrossing0 = (kFarFace + 4.0 * kSideFace) * kY0;
const float kCrossing1 = (kFarFace + 4.0 * kAlong * kSideFace) * kY1;

// Flux across a face with the given outward normal, W.
float fluxAcross(vec4 coefficients, vec3 normal) {
  return kCrossing0 * coefficients.x + kCrossing1 * dot(coefficients.yzw, normal.yzx);
}

// Mean projected area of a cell over its squared size: a quarter of its surface area (Cauchy).
const float kMeanProjection = 1.5;
