// A step through voxels with six faces whose levels all cover the whole store. Including files first define
//   vec4 interpolated(vec3 at, vec3 direction, float level)          the faces at a point, filtered along all axes and between levels
//   vec4 layers(vec3 at, vec3 direction, float level, float stride)  a step through three layers of voxels of one level
//
// Deviates from Listing 4.15: for each face, a step of `stride` through one level reads the layer of voxels across the face's axis that
// contains the middle of the step, filtered within the layer only. The transmittances of the three faces are multiplied. No wall is missed
// then, while filtering gives openings their edges. Filtered along all axes, the opacity of a wall falls linearly to both sides, and steps
// through the wall transmit exp(-2 / cos) (see the card). A uniform medium of opacity a transmits (1-a)^lengths either way, because the
// weights sum to 1.

bool readsLayers() { return storeLayers != 0; }

// Step limit, m: no step skips a layer of the finer of the two levels that are read.
float longestStep(float size) { return readsLayers() ? storeVoxel * exp2(floor(log2(max(size / storeVoxel, 1.0)))) : kNoLimit; }

StoreSample readStore(vec3 at, vec3 direction, float size, float stride) {
  float blend, level = levelOf(max(size / storeVoxel, 1.0), storeCoarsest, blend);
  if (readsLayers()) {
    if (blend <= 0.0) {
      vec4 value = layers(at, direction, level, stride);
      return StoreSample(value, value.a);
    }
    // Where the coarser level is empty, so is the finer level from which it was filtered. Most of a room is empty.
    vec4 coarser = layers(at, direction, level + 1.0, stride);
    if (coarser.a <= 0.0) return StoreSample(vec4(0.0), 0.0);
    vec4 value = mix(layers(at, direction, level, stride), coarser, blend);
    return StoreSample(value, value.a);
  }
  StoreSample result = StoreSample(interpolated(at, direction, level + blend), 0.0);
  if (result.value.a > 0.0) result.opacity = opacityOfStep(result.value.a, stride, level, blend);
  return result;
}
