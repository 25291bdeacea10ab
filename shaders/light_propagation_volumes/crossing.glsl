// One step of the propagation from a cell to its neighbour, reduced to five constants.
// The sums over the five faces of the neighbour, solid angle s, direction d: with coefficients c0 and c1 along the step, c2 across,
//   c0' = Y0 sum s I(d)                               = stay c0 + gain c1
//   c1' = Y1 sum s I(d) (d along the step)            = turn c0 + along c1
//   c2' = Y1 sum s I(d) (d across the step)           = across c2
// where light keeps its direction d. Deviates from Kaplanyan & Dachsbacher 2010, Sec. 4.3, where light leaves again as a clamped cosine
// around the normal of the face that it reaches (cosineLobe): see README, "propagation". Both are stable for any occlusion. The map from
// coefficients to flux times 1 / sqrt(s) is an isometry, since the thirty directions integrate the products of two harmonics exactly. An
// open share is at most 1. The sums are the transpose of that isometry, or shorter.
const float kStay0 = kCrossing0 * kY0;
const float kGain = kCrossing1 * kY0;
float turnShare() { return cosineLobe != 0 ? (2.0 / 3.0) * kFarFace * kY0 * kY1 : kGain; }
float stayAlong() { return kY1 * kY1 * (cosineLobe != 0 ? (2.0 / 3.0) * kFarFace : kFarFace + 4.0 * kAlong * kAlong * kSideFace); }
float stayAcross() { return kY1 * kY1 * 2.0 * kSideFace * kAcross * (cosineLobe != 0 ? 2.0 / 3.0 : kAcross); }

// `along` in the order of the harmonics: (0, y, z, x) of the direction of travel.
vec4 crossFace(vec4 c, vec4 along) {
  float c1 = dot(c, along);
  return vec4(kStay0 * c.x + kGain * c1, stayAcross() * c.yzw) + along * (turnShare() * c.x + (stayAlong() - stayAcross()) * c1);
}
