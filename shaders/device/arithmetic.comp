#version 450
// Arithmetic in registers: eight independent chains, so that no latency shows. Each chain converges to
// a known number, which the caller checks.
#pragma lumivox axis FUNCTION product fused integer exponential sine root

layout(local_size_x = 512) in;

layout(std140, binding = 0) uniform Parameters {
  uint rounds;
  float factor;
  float addend;
};
layout(std430, binding = 0) writeonly buffer Results { vec4 results[]; };

const uint kStepsPerRound = 8u;  // of eight chains each

#if FUNCTION == FUNCTION_PRODUCT
vec4 next(vec4 x) { return x * factor + addend; }              // to addend / (1 - factor)
#elif FUNCTION == FUNCTION_FUSED
vec4 next(vec4 x) { return fma(x, vec4(factor), vec4(addend)); }
#elif FUNCTION == FUNCTION_EXPONENTIAL
vec4 next(vec4 x) { return exp(-x); }                          // to 0.567143: x e^x = 1
#elif FUNCTION == FUNCTION_SINE
vec4 next(vec4 x) { return cos(x); }                           // to 0.739085: x = cos x
#elif FUNCTION == FUNCTION_ROOT
vec4 next(vec4 x) { return inversesqrt(x); }                   // to 1
#endif

#if FUNCTION == FUNCTION_INTEGER
// Marsaglia 2003, "Xorshift RNGs": a compiler cannot merge several steps.
uvec4 next(uvec4 x) {
  x ^= x << 13u;
  x ^= x >> 17u;
  return x ^ x << 5u;
}
#endif

void main() {
  uint i = gl_GlobalInvocationID.x;
#if FUNCTION == FUNCTION_INTEGER
  uvec4 a = uvec4(i + 1u, i + 2u, i + 3u, i + 4u), b = a + 4u;
#else
  vec4 a = 0.5 + vec4(i & 7u) * vec4(0.01, 0.02, 0.03, 0.04), b = a + 0.05;
#endif
  for (uint round = 0u; round < rounds; ++round)
    for (uint k = 0u; k < kStepsPerRound; ++k) {
      a = next(a);
      b = next(b);
    }
#if FUNCTION == FUNCTION_INTEGER
  results[i] = uintBitsToFloat(a ^ b);
#else
  results[i] = 0.5 * (a + b);
#endif
}
