// Coverage of a voxel's sides by samples, as in 3D clipmaps (thesis 004 Sec. 3.5.2). Including files declare before: kMostSamples,
// sampleCount, samples (x and y inside the pixel, 0..1), thickness (voxels), mostScale (pixels along a voxel, at most); and have
// common/triangle.glsl.
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

// Bits of the planes across the grid's axes x, y, z that the covered samples of a slice of voxels set, for a triangle with this dominant
// axis: of that axis the samples as they are; they are projected into the other planes, where the surface is made thicker along it.
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

// Adaptive supersampling: the pixels of a triangle that covers few samples are halved until it covers this many samples or the pixels are
// the smallest.
const float kEnoughSamples = 16.0;

int scaleOf(mat3 corners) {
  vec2 e1 = corners[1].xy - corners[0].xy, e2 = corners[2].xy - corners[0].xy;
  float samples = 0.5 * abs(e1.x * e2.y - e1.y * e2.x) * float(sampleCount);
  int result = 1;
  while (result < mostScale && samples * float(result * result) < kEnoughSamples) result *= 2;
  return result;
}

#endif
