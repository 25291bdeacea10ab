#version 450
// Importance of each row of texels of all layers: the sum of the luminances of their flux.
#include "common/rsm.glsl"

layout(local_size_x = 64) in;

layout(std140, binding = 0) uniform Parameters {
  int width;
  int rows;  // of all layers together
};
layout(binding = 0) uniform sampler2DArray rsmFlux;
layout(std430, binding = 0) writeonly buffer Rows { float cumulative[]; };

void main() {
  int row = int(gl_GlobalInvocationID.x);
  if (row >= rows) return;
  float sum = 0.0;
  // Layers are square.
  for (int x = 0; x < width; ++x) sum += luminance(texelFetch(rsmFlux, ivec3(x, row % width, row / width), 0).rgb);
  cumulative[row] = sum;
}
