// Cone steps that treat opacity as the share of the cone's width that surfaces cover, instead of the opacity of a medium.
//
// The transmittances of a medium multiply from voxel to voxel. For surfaces this is wrong in two ways. First, the trilinear filter reads a
// closed sheet in one layer of voxels as opacities that rise to 1 and fall again over one voxel on either side. The sheet then transmits
// exp(2 int_0^1 ln(1 - x) dx) = exp(-2) of the light. Second, all layers of a solid object that covers half of the cone hide the same half,
// not half of the rest. So the opacity of the voxels counts as the covered share. Within one object the largest share counts; from object
// to object the open shares multiply. Below a quarter of its peak the object ends by degrees: the covered share is at most four times the
// opacity, so that a rise from 0 counts in full.
#include "store.glsl"

struct Covering {
  float through;  // share of the cone that is still open
  float covered;  // share that the current object covers
};
const Covering kOpen = Covering(1.0, 0.0);

// Takes a step of `stride` m through voxels of `size` m. Returns the share of the whole cone that this step covers.
float cover(inout Covering cone, StoreSample found, float size, float stride) {
  const float kOneThing = 4.0;  // factor by which the opacity must fall before a rise counts as another object
  float opacity = found.value.a;
  if (readsLayers()) {
    // Layers are not filtered across their axis, and their opacity is that of the step: it is converted to that of the longest step.
    if (opacity > 0.0) opacity = 1.0 - pow(max(1.0 - opacity, 0.0), longestStep(size) / stride);
  } else {
    // A closed sheet filtered between two levels is (1-f) max(0, 1 - |x|) + f max(0, 1 - |x - 1/2| / 2), with its maximum at 0 or at 1/2.
    // Steps miss the maximum by a quarter of their length on average and by half at most; the latter counts the more, the less is open.
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

// The same for a medium, as in traceCone().
float coverByMedium(inout Covering cone, StoreSample found) {
  float before = cone.through;
  cone.through *= 1.0 - found.opacity;
  return before - cone.through;
}
