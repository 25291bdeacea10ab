#version 450
// Bounds of the depth intervals of each view: of equal width, or with equal numbers of texels, to the accuracy of the bins.
#pragma lumivox axis INTERVALS equal population
layout(local_size_x = 64) in;
#include "slots.glsl"
#include "bins.glsl"

#if INTERVALS == INTERVALS_POPULATION
layout(std430, binding = 1) readonly buffer Bins { uint bins[]; };
#endif
layout(std430, binding = 2) writeonly buffer Bounds { float bounds[]; };  // m, depthLayers + 1 per view

void main() {
  int view = int(gl_GlobalInvocationID.x);
  if (view >= viewCount) return;
  int first = view * (depthLayers + 1);
  bool empty = isEmpty(view);
  float low = empty ? 0.0 : lowestOf(view), high = empty ? 0.0 : highestOf(view);
#if INTERVALS == INTERVALS_POPULATION
  uint all = 0u;
  for (int i = 0; i < kBins; ++i) all += bins[view * kBins + i];
  float before = 0.0;
  int next = 1;  // the next bound
  // A bin may contain several bounds: each iteration completes a bin or a bound.
  for (int turn = 0, bin = 0; turn < kBins + depthLayers && bin < kBins && next < depthLayers; ++turn) {
    float own = float(bins[view * kBins + bin]), wanted = float(all) * float(next) / float(depthLayers);
    if (own > 0.0 && before + own >= wanted) {
      float place = (float(bin) + (wanted - before) / own) / float(kBins);
      bounds[first + next] = mix(low, high, clamp(place, 0.0, 1.0));
      ++next;
    } else {
      before += own;
      ++bin;
    }
  }
  for (; next < depthLayers; ++next) bounds[first + next] = high;
#else
  for (int i = 1; i < depthLayers; ++i) bounds[first + i] = mix(low, high, float(i) / float(depthLayers));
#endif
  bounds[first] = low;
  bounds[first + depthLayers] = high;
}
