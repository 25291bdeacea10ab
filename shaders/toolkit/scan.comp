#version 450
// Exclusive prefix sum, in place, of each of several columns. One work group.
// C++ side: scan() in framework/include/lumivox/toolkit/counts.h.
#pragma lumivox axis TOTALS 0 1
layout(local_size_x = 64) in;

layout(std140, binding = 0) uniform Scan { uint items, columns; };
layout(std430, binding = 0) buffer Numbers { uint numbers[]; };  // the columns of an item are adjacent
#if TOTALS
layout(std430, binding = 1) writeonly buffer Totals { uint totals[]; };  // a word per column
#endif

shared uint parts[64];

void main() {
  uint thread = gl_LocalInvocationID.x, each = (items + 63u) / 64u, first = thread * each, end = min(first + each, items);
  for (uint column = 0u; column < columns; ++column) {
    uint sum = 0u, before = 0u;
    for (uint i = first; i < end; ++i) sum += numbers[columns * i + column];
    parts[thread] = sum;
    memoryBarrierShared();
    barrier();
    for (uint i = 0u; i < thread; ++i) before += parts[i];
#if TOTALS
    if (thread == 63u) totals[column] = before + sum;
#endif
    for (uint i = first; i < end; ++i) {
      uint number = numbers[columns * i + column];
      numbers[columns * i + column] = before;
      before += number;
    }
    barrier();  // the next column reuses `parts`
  }
}
