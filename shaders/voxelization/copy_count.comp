#version 450
// Copies a number of items on the device, without a read-back.
layout(local_size_x = 1) in;

layout(std430, binding = 0) readonly buffer From { uint fromCount; };
layout(std430, binding = 1) writeonly buffer To { uint toCount; };

void main() { toCount = fromCount; }
