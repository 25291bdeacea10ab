#version 450
// A bilateral filter of depth: a mean over neighbours in the image, weighted by their distance there and by their difference in depth, so that
// noise averages out and edges stay.
layout(local_size_x = 8, local_size_y = 8) in;
#include "camera.glsl"

layout(std140, binding = 0) uniform Parameters {
  int radius;     // pixels
  float falloff;  // 1 / (2 sigma^2), 1/pixel^2
  float range;    // sigma over depth, in standard deviations of a depth
};
layout(binding = 0) uniform sampler2DArray capturedDepth;
layout(binding = 0, r32f) uniform writeonly image2DArray filteredImage;

void main() {
  ivec3 pixel = ivec3(gl_GlobalInvocationID), size = textureSize(capturedDepth, 0);
  if (any(greaterThanEqual(pixel, size))) return;
  float depth = texelFetch(capturedDepth, pixel, 0).r, result = 0.0;
  if (depth > 0.0) {
    float deviation = range * depthDeviation(depth), narrow = deviation > 0.0 ? 0.5 / (deviation * deviation) : 0.0;
    float sum = 0.0, weights = 0.0;
    ivec2 first = max(pixel.xy - radius, ivec2(0)), last = min(pixel.xy + radius, size.xy - 1);
    for (int y = first.y; y <= last.y; ++y) {
      for (int x = first.x; x <= last.x; ++x) {
        float other = texelFetch(capturedDepth, ivec3(x, y, pixel.z), 0).r;
        vec2 apart = vec2(x, y) - vec2(pixel.xy);
        float difference = other - depth;
        float weight = other > 0.0 ? exp(-falloff * dot(apart, apart) - narrow * difference * difference) : 0.0;
        sum += weight * difference;
        weights += weight;
      }
    }
    result = deviation > 0.0 ? depth + sum / weights : depth;
  }
  imageStore(filteredImage, pixel, vec4(result));
}
