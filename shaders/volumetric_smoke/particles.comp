#version 450
// Thesis 004, Sec. 4.5: the particle system, here without a state: any frame can be made alone.
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
layout(std430, binding = 0) writeonly buffer Offsets { vec4 offsets[]; };

void main() {
  uint index = listIndex();
  if (index >= count) return;
  offsets[index] = particleAt(index, seed, lives, share, life, spread, drift, rise);
}
