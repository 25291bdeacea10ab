#version 450
// Regular sub-sampling: the texel in the middle of each square of `stride` x `stride` texels of a layer becomes a light for the square.
#pragma lumivox axis GLOSSY 0 1  // the map has lobes
layout(local_size_x = 64) in;
#include "common/list.glsl"
#include "taken.glsl"

layout(std140, binding = 0) uniform Parameters {
  int width, height;  // texels of a layer
  int stride;
  int across, down;  // squares of a layer
  int count;   // squares of all layers
  int area;    // of lights: taken.glsl
};

void main() {
  uint index = listIndex();
  if (index >= uint(count)) return;
  ivec3 square = ivec3(int(index) % across, int(index) / across % down, int(index) / across / down);
  // At the borders a square may be cut off.
  ivec2 first = square.xy * stride, size = min(ivec2(stride), ivec2(width, height) - first);
  taken[index] = texelLight(ivec3(first + size / 2, square.z), float(size.x * size.y), area);
}
