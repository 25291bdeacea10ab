#version 450
// Storage buffers: reads, reads of the same element by all invocations, writes, atomics on separate words, and atomics on one word for all.
#pragma lumivox axis ACCESS read same write add contend

layout(local_size_x = 512) in;

layout(std140, binding = 0) uniform Parameters {
  uint rounds;
  uint mask;          // number of elements less one; a power of two less one
  uint apart;         // distance between two accesses, in elements
};
#if ACCESS == ACCESS_READ || ACCESS == ACCESS_SAME || ACCESS == ACCESS_WRITE
layout(std430, binding = 0) buffer Elements { uvec4 elements[]; };
#else
layout(std430, binding = 1) buffer Words { uint words[]; };
#endif
#if ACCESS == ACCESS_READ || ACCESS == ACCESS_SAME
layout(std430, binding = 2) writeonly buffer Results { uvec4 results[]; };
#endif

const uint kAccessesPerRound = 8u;

void main() {
  uint i = gl_GlobalInvocationID.x;
#if ACCESS == ACCESS_SAME
  uint at = 0u;
#else
  uint at = i;
#endif
  uvec4 sum = uvec4(0u);
  for (uint round = 0u; round < rounds; ++round)
    for (uint k = 0u; k < kAccessesPerRound; ++k) {
      at = at + apart & mask;
#if ACCESS == ACCESS_READ || ACCESS == ACCESS_SAME
      sum += elements[at];
#elif ACCESS == ACCESS_WRITE
      elements[at] = uvec4(at);
#elif ACCESS == ACCESS_ADD
      atomicAdd(words[at], 1u);
#else
      atomicAdd(words[0], 1u);
#endif
    }
#if ACCESS == ACCESS_READ || ACCESS == ACCESS_SAME
  results[i] = sum;
#endif
}
