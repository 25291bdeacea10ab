#version 450
// Texels chosen in proportion to the luminance of their flux: sample j takes the texel that holds the share (j + 1/2) / n of all flux.
// Dividing by the probability makes the sum over the samples an estimate of the sum over all texels, without bias in the limit.
#include "common/rsm.glsl"

layout(local_size_x = 64) in;

layout(std140, binding = 0) uniform Parameters {
  int width;
  int rows;
  int samples;
};
layout(binding = 0) uniform sampler2DArray rsmPosition;
layout(binding = 1) uniform sampler2DArray rsmNormal;
layout(binding = 2) uniform sampler2DArray rsmFlux;
layout(std430, binding = 0) readonly buffer Rows { float cumulative[]; };
layout(std430, binding = 1) writeonly buffer Chosen { SurfaceLight chosen[]; };

void main() {
  int index = int(gl_GlobalInvocationID.x);
  if (index >= samples) return;
  float total = cumulative[rows - 1];
  SurfaceLight light = SurfaceLight(vec4(0.0), vec4(0.0), vec4(0.0));
  if (total > 0.0) {
    float target = total * ((float(index) + 0.5) / float(samples));
    int low = 0, high = rows - 1;
    while (low < high) {
      int middle = (low + high) / 2;
      if (cumulative[middle] > target) high = middle;
      else low = middle + 1;
    }
    float rest = target - (low > 0 ? cumulative[low - 1] : 0.0);
    ivec3 texel = ivec3(0, low % width, low / width), last = texel;
    float weight = 0.0;
    for (; texel.x < width; ++texel.x) {
      float here = luminance(texelFetch(rsmFlux, texel, 0).rgb);
      if (here <= 0.0) continue;
      last = texel;
      weight = here;
      rest -= here;
      if (rest < 0.0) break;
    }
    // Each sample stands for total / samples of the flux, and for as much more area as it stands for more texels.
    float copies = weight > 0.0 ? total / (float(samples) * weight) : 0.0;
    vec4 normalArea = texelFetch(rsmNormal, last, 0);
    light.positionArea = vec4(texelFetch(rsmPosition, last, 0).xyz, normalArea.w * copies);
    light.normal = vec4(normalArea.xyz, 0.0);
    light.flux = vec4(texelFetch(rsmFlux, last, 0).rgb * copies, 0.0);
  }
  chosen[index] = light;
}
