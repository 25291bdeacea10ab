#version 450
// The part of each shadow view that the bounds of moving geometry cover.
layout(local_size_x = 64) in;
#define SHADOW_VIEWS
#include "common/lights.glsl"
#include "boxes_in_views.glsl"

layout(std140, binding = 0) uniform Boxes { int boxCount, layerCount; };
struct Box {
  vec4 low, high;  // m
};
layout(std430, binding = 0) readonly buffer Moving { Box moving[]; };
layout(std430, binding = 1) writeonly buffer Casts { Cast casts[]; };

void main() {
  int item = int(gl_GlobalInvocationID.x);
  if (item >= boxCount * layerCount) return;
  Box box = moving[item % boxCount];
  casts[item] = castOf(views[item / boxCount], box.low.xyz, box.high.xyz);
}
