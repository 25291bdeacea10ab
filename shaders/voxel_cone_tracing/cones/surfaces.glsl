// Steps along cones that ask how much of their width surfaces cover, and not how thick a medium is.
//
// A medium's transmittances multiply from voxel to voxel. Of surfaces that is wrong twice. A closed sheet in one layer of voxels is read by the
// trilinear filter as opacities that rise to 1 and fall again within a voxel, of which exp(2 int_0^1 ln(1 - x) dx) = exp(-2) of the light is
// left. And of a solid thing that covers half of the cone every layer hides the same half, not half of what is left. So the opacity of the
// voxels counts as the covered share: within one thing the largest that was met, from thing to thing the product of what they leave open.
// A thing ends where the opacity falls; what rises again from a quarter of it counts in full.
#include "store.glsl"

struct Covering {
  float through;  // share of the cone that is open still
  float covered;  // share that the thing covers in which the cone is
};
const Covering kOpen = Covering(1.0, 0.0);

// Takes a step of `stride` m through voxels of `size` m; the share of the whole cone that is covered by it.
float cover(inout Covering cone, StoreSample found, float size, float stride) {
  const float kOneThing = 4.0;  // how often the opacity must fall for what follows to be another thing
  float opacity = found.value.a;
  if (readsLayers()) {
    // Layers are not filtered across, and their value is that of the step; no longer step lies in one.
    if (opacity > 0.0) opacity = 1.0 - pow(max(1.0 - opacity, 0.0), longestStep(size) / stride);
  } else {
    // What the filter makes of a closed sheet between two levels, (1-f) max(0, 1 - |x|) + f max(0, 1 - |x - 1/2| / 2), has its top at 0 or
    // at 1/2. Steps miss it by a quarter of themselves in the mean, and by a half at most, which counts where little is open.
    float f;
    levelOf(size / storeVoxel, storeCoarsest, f);
    opacity /= max(1.0 - 0.25 * f, 0.5 + 0.5 * f);
    opacity /= max(1.0 - (0.25 + 0.25 * min(opacity, 1.0)) * stride / size, 0.5);
  }
  opacity = min(opacity, 1.0);
  cone.covered = min(cone.covered, kOneThing * opacity);
  if (opacity <= cone.covered) return 0.0;
  float before = cone.through;
  cone.through *= (1.0 - opacity) / (1.0 - cone.covered);
  cone.covered = opacity;
  return before - cone.through;
}

// The same of a medium, as the other cones see it.
float coverByMedium(inout Covering cone, StoreSample found) {
  float before = cone.through;
  cone.through *= 1.0 - found.opacity;
  return before - cone.through;
}
