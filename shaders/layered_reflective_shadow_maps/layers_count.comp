#version 450
// Counts the texels of each view in each bin of its depths.
layout(local_size_x = 8, local_size_y = 8) in;
#include "slots.glsl"
#include "bins.glsl"

layout(std430, binding = 1) buffer Bins { uint bins[]; };

void main() {
  ivec3 texel = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(texel, textureSize(rsmPosition, 0)))) return;
  MapTexel seen = texelOf(texel);
  if (!seen.covered) return;
  float low = lowestOf(texel.z), extent = highestOf(texel.z) - low;
  float share = extent > 0.0 ? (depthOf(lights[seen.light], texel.z, seen.posWorld) - low) / extent : 0.0;
  int bin = clamp(int(share * float(kBins)), 0, kBins - 1);
  atomicAdd(bins[texel.z * kBins + bin], 1u);
}
