// Random numbers by hashing: a number depends only on the words that name its purpose.
#ifndef LUMIVOX_RANDOM
#define LUMIVOX_RANDOM

// Hash of four words to four words (Jarzynski & Olano 2020, "Hash functions for GPU rendering", Sec. 4, pcg4d).
uvec4 hash4(uvec4 v) {
  v = v * 1664525u + 1013904223u;
  v.x += v.y * v.w;
  v.y += v.z * v.x;
  v.z += v.x * v.y;
  v.w += v.y * v.z;
  v ^= v >> 16u;
  v.x += v.y * v.w;
  v.y += v.z * v.x;
  v.z += v.x * v.y;
  v.w += v.y * v.z;
  return v;
}

// Uniform in [0, 1): 24 bits, so that the result is exact and never 1.
vec2 unitInterval(uvec2 bits) { return vec2(bits >> 8u) * (1.0 / 16777216.0); }

#endif
