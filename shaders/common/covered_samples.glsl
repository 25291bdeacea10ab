// Coverage of a voxel's sides by samples, as in 3D clipmaps (thesis 004 Sec. 3.5.2). Including files first include common/triangle.glsl and
// declare kMostSamples, sampleCount, samples (x and y inside the pixel, 0..1), thickness (voxels) and mostScale (largest number of pixels
// along a voxel).
#ifndef LUMIVOX_COVERED_SAMPLES
#define LUMIVOX_COVERED_SAMPLES

// The bit of the sample nearest to a point of a voxel's side.
uint nearestSample(vec2 point) {
  int best = 0;
  float least = 1e9;
  for (int i = 0; i < sampleCount; ++i) {
    vec2 offset = samples[i].xy - point;
    float distanceSquared = dot(offset, offset);
    if (distanceSquared < least) {
      least = distanceSquared;
      best = i;
    }
  }
  return 1u << best;
}

// Bits that the covered samples of a slice of voxels set in the planes across the grid's axes x, y, z, for a triangle with this dominant
// axis. The plane across the dominant axis takes the samples unchanged. The other two planes take their projections, with the surface
// thickened along the dominant axis.
uint sideMasks(uint covered, float depths[kMostSamples], float slice, int axis) {
  uvec3 masks = uvec3(0u, 0u, covered);  // across the permuted axes
  for (int i = 0; i < sampleCount; ++i) {
    if ((covered >> i & 1u) == 0u) continue;
    for (int step = -1; step <= 1; ++step) {
      float depth = depths[i] - slice + 0.5 * thickness * float(step);
      if (depth < 0.0 || depth >= 1.0) continue;
      masks.x |= nearestSample(vec2(samples[i].y, depth));
      masks.y |= nearestSample(vec2(depth, samples[i].x));
    }
  }
  ivec3 across = unpermute(ivec3(masks), axis);
  return uint(across.x) | uint(across.y) << kMostSamples | uint(across.z) << (2 * kMostSamples);
}

// Adaptive supersampling: if a triangle covers few samples, its pixels are halved until it covers this many samples or the pixels have
// the smallest size.
const float kEnoughSamples = 16.0;

int scaleOf(mat3 corners) {
  vec2 e1 = corners[1].xy - corners[0].xy, e2 = corners[2].xy - corners[0].xy;
  float samples = 0.5 * abs(e1.x * e2.y - e1.y * e2.x) * float(sampleCount);
  int result = 1;
  while (result < mostScale && samples * float(result * result) < kEnoughSamples) result *= 2;
  return result;
}

#endif
