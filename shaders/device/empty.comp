#version 450
// Measures the cost of a dispatch alone.
layout(local_size_x = 1) in;
layout(std430, binding = 0) writeonly buffer Results { uint results[]; };
void main() { results[0] = 1u; }
