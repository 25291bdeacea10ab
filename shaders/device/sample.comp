#version 450
// Texture sampling in the best case (neighbouring invocations read neighbouring texels) and in the worst case (random positions).
#pragma lumivox axis KIND d2 d3 shadow
#pragma lumivox axis PATTERN coherent scattered

layout(local_size_x = 512) in;

layout(std140, binding = 0) uniform Parameters {
  uint rounds;        // rounds of kSamplesPerRound samples
  uint width;         // invocations in a row
  float level;        // mip level; a fraction reads two levels
  float step;         // change of the position from sample to sample, along each axis
};
#if KIND == KIND_D3
layout(binding = 0) uniform sampler3D volume;
#elif KIND == KIND_SHADOW
layout(binding = 1) uniform sampler2DArrayShadow depths;
#else
layout(binding = 2) uniform sampler2D image;
#endif
layout(std430, binding = 0) writeonly buffer Results { vec4 results[]; };

const uint kSamplesPerRound = 8u;

#if PATTERN == PATTERN_SCATTERED
uint state;
// A linear congruential generator of 32 bits (Press et al. 2007, Numerical Recipes, Sec. 7.1.7); its upper bits are positions.
vec3 nextPosition(vec3) {
  state = state * 1664525u + 1013904223u;
  return vec3(state >> 22u, state >> 12u & 1023u, state >> 17u & 1023u) * (0.75 / 1023.0) + 0.125;
}
#else
vec3 nextPosition(vec3 position) { return position + step; }
#endif

vec4 take(vec3 position) {
#if KIND == KIND_D3
  return textureLod(volume, position, level);
#elif KIND == KIND_SHADOW
  return vec4(texture(depths, vec4(position.xy, 0.0, position.z)));
#else
  return textureLod(image, position.xy, level);
#endif
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  // Rows of neighbours in the middle of the texture; steps move them at most 0.25 further.
  vec3 position = vec3(float(i % width) / float(width), float(i / width % width) / float(width),
                       float(i % 61u) / 61.0) * 0.5 + 0.125;
#if PATTERN == PATTERN_SCATTERED
  state = i * 747796405u + 2891336453u;
#endif
  vec4 sum = vec4(0.0);
  vec3 start = position;
  for (uint round = 0u; round < rounds; ++round) {
    // Rounds differ a little, so that no two rounds are the same.
    position = start + float(round & 7u) * 0.125 * step;
    for (uint k = 0u; k < kSamplesPerRound; ++k) {
      position = nextPosition(position);
      sum += take(position);
    }
  }
  results[i] = sum;
}
