#version 450
// A number of items travels on the device alone.
layout(local_size_x = 1) in;

layout(std430, binding = 0) readonly buffer From { uint fromCount; };
layout(std430, binding = 1) writeonly buffer To { uint toCount; };

void main() { toCount = fromCount; }
