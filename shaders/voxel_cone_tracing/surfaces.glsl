// Steps along cones that ask whether surfaces are in the way, and not how thick a medium is.
//
// A sheet of opacity a that lies in one layer of voxels is read by the trilinear filter as opacities a (1 - |x|) within a voxel before and
// behind it. Taken for a medium, whose transmittances 1 - a multiply from voxel to voxel, it lets exp(2 int_0^1 ln(1 - a x) dx) through: of
// an opaque one exp(-2) = 0.135. Wanted is 1 - a. The optical depth h per voxel that gives this obeys
//   2 int_0^1 h(a x) dx = -ln(1 - a), so that h(a) = (-ln(1 - a) + a / (1 - a)) / 2.
// Thin media keep theirs: h = a + 3/4 a^2 + ... beside a + 1/2 a^2 + ....
#include "store.glsl"

// Transmittance of a step through surfaces.
float throughSurfaces(StoreSample found) {
  const float kThin = 1e-3, kMost = 0.9999;  // below, the two depths agree to 10^-3; above, logarithms lose their digits
  float through = 1.0 - found.opacity, opacity = min(found.value.a, kMost);
#if STORE == STORE_DIRECTIONAL
  if (storeLayers != 0) return through;  // layers are not filtered across: a sheet lets 1 - a through
#endif
  if (opacity < kThin || through <= 0.0) return through;
  float mediumDepth = -log(1.0 - opacity);
  return pow(through, 0.5 + 0.5 * opacity / ((1.0 - opacity) * mediumDepth));
}
