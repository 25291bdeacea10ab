#version 450
// Thesis 004, Sec. 4.5: the particle system. Deviates: it has no state, so that any frame can be rendered alone.
#include "common/particles.glsl"

layout(local_size_x = 64) in;
#include "common/list.glsl"

layout(std140, binding = 0) uniform Parameters {
  uint count;
  uint seed;
  uint lives;   // whole lives since time 0
  float share;  // of the present life, [0,1)
  float life;   // s
  float spread; // m
  float drift;  // m/s
  float rise;   // m/s
};
layout(std430, binding = 0) writeonly buffer Offsets { float offsets[]; };  // x, y, z per particle

void main() {
  uint index = listIndex();
  if (index >= count) return;
  vec3 offset = particleAt(index, seed, lives, share, life, spread, drift, rise).xyz;
  offsets[3u * index] = offset.x;
  offsets[3u * index + 1u] = offset.y;
  offsets[3u * index + 2u] = offset.z;
}
