#version 450
// Chooses texels in proportion to the luminance of their flux: sample j takes the texel at the share (j + 1/2) / n of the cumulative flux.
// Division by the probability makes the sum over the samples an estimate of the sum over all texels, without bias in the limit.
#pragma lumivox axis GLOSSY 0 1  // the map has lobes
layout(local_size_x = 64) in;
#include "common/list.glsl"
#include "sum_tree.glsl"
#include "taken.glsl"

layout(std140, binding = 0) uniform Parameters {
  uint texels;
  uint levels;   // levels of sums
  uint samples;
  int area;      // of lights: taken.glsl
  uint width, height, rows, together, ways;  // TexelOrder
};
layout(std430, binding = 0) readonly buffer Tree { float sums[]; };

void main() {
  uint index = listIndex();
  if (index >= samples) return;
  TexelOrder order = TexelOrder(width, height, rows, together, ways);
  float total = sums[0];
  SurfaceLight light = SurfaceLight(vec4(0.0), vec4(0.0), vec4(0.0));
  if (total > 0.0) {
    float rest = total * ((float(index) + 0.5) / float(samples)), weight = 0.0;
    uint entry = 0u, firstOfLevel = 0u;
    // Descend the tree: take the child in which the rest of the share ends; if rounding leaves a remainder, the last child with flux.
    for (uint level = levels; level > 0u; --level) {
      firstOfLevel += levelSize(texels, level);
      uint child = entry * kFan, end = min(child + kFan, levelSize(texels, level - 1u));
      ivec3 texel = texelOf(child, order);
      entry = child;
      weight = 0.0;
      for (; child < end; ++child) {
        float here;
        if (level > 1u) {
          here = sums[firstOfLevel + child];
        } else {
          here = luminance(texelFetch(rsmFlux, texel, 0).rgb);
          advance(texel, order);
        }
        if (here <= 0.0) continue;
        entry = child;
        weight = here;
        rest -= here;
        if (rest < 0.0) break;
      }
      rest += weight;
    }
    // Each sample represents total / samples of the flux; its area grows with the number of texels that it represents.
    float copies = weight > 0.0 ? total / (float(samples) * weight) : 0.0;
    light = texelLight(texelOf(entry, order), copies, area);
  }
  taken[index] = light;
}
