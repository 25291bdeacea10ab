// A step through voxels with six faces whose levels all cover the whole store. Including files say before
//   vec4 interpolated(vec3 at, vec3 direction, float level)          the faces at a point, filtered along all axes and between levels
//   vec4 layers(vec3 at, vec3 direction, float level, float stride)  what a step through one level sees of three layers of voxels
//
// Deviates from Listing 4.15: a step of `stride` through one level takes of each face the layer of voxels across its axis that its middle
// lies in, filtered across that axis alone, and multiplies what the faces let through. Filtered along all axes the opacity of a wall falls
// linearly to both sides, and steps through it let exp(-2 / cos) through (see the card); so no wall is missed, while an opening has the
// edges that filtering gives it. A uniform medium of opacity a lets (1-a)^lengths through either way, since the weights sum to 1.

bool readsLayers() { return storeLayers != 0; }

// No step skips a layer of the finer of the two levels that are read.
float longestStep(float size) { return readsLayers() ? storeVoxel * exp2(floor(log2(max(size / storeVoxel, 1.0)))) : kNoLimit; }

StoreSample readStore(vec3 at, vec3 direction, float size, float stride) {
  float blend, level = levelOf(max(size / storeVoxel, 1.0), storeCoarsest, blend);
  if (readsLayers()) {
    if (blend <= 0.0) {
      vec4 value = layers(at, direction, level, stride);
      return StoreSample(value, value.a);
    }
    // Where the coarser level is empty the finer one is: its voxels are what that one was made of. Most of a room is.
    vec4 coarser = layers(at, direction, level + 1.0, stride);
    if (coarser.a <= 0.0) return StoreSample(vec4(0.0), 0.0);
    vec4 value = mix(layers(at, direction, level, stride), coarser, blend);
    return StoreSample(value, value.a);
  }
  StoreSample result = StoreSample(interpolated(at, direction, level + blend), 0.0);
  if (result.value.a > 0.0) result.opacity = opacityOfStep(result.value.a, stride, level, blend);
  return result;
}
