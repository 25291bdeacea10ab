// The position and age of a particle as a pure function of its number, a seed and the time: the same arithmetic, to the bit, as in
// framework/src/scene/medium.cpp, where it is explained.
#ifndef LUMIVOX_PARTICLES
#define LUMIVOX_PARTICLES
#include "common/random.glsl"

// Numbers in (-1, 1) with a triangular distribution around 0, from the sum of the halves of random words: exact in single precision.
vec3 aroundZero(uvec3 words) {
  uvec3 sum = (words >> 16u) + (words & 0xffffu);
  return (vec3(sum) + 1.0) * (1.0 / 65536.0) - 1.0;
}

// `lives` and `share`: integer and fractional part of the time in lifetimes. Returns xyz position relative to the source, w age.
vec4 particleAt(uint index, uint seed, uint lives, float share, float life, float spread, float drift, float rise) {
  float birth = unitInterval(hash4(uvec4(index, 0u, seed, 0u)).xy).x;
  float lived = share + birth;
  if (lived >= 1.0) {
    lived -= 1.0;
    ++lives;
  }
  float age = lived * life;
  vec3 start = aroundZero(hash4(uvec4(index, 2u * lives + 1u, seed, 0u)).xyz);
  vec3 velocity = aroundZero(hash4(uvec4(index, 2u * lives + 2u, seed, 0u)).xyz) * drift + vec3(0.0, rise, 0.0);
  return vec4(start * spread + velocity * age, age);
}

#endif
