#version 450
// Lists the layers in the order of their slots, and the range of layers of each view.
layout(local_size_x = 64) in;
#include "common/list.glsl"
#include "layer.glsl"
#include "slots.glsl"

layout(std430, binding = 2) readonly buffer Bounds { float bounds[]; };
layout(std430, binding = 3) readonly buffer Numbers { uint numbers[]; };  // for each slot, the number of layers before it
layout(std430, binding = 4) readonly buffer Total { uint total; };
layout(std430, binding = 7) writeonly buffer Layers { Layer layers[]; };
layout(std430, binding = 8) writeonly buffer ViewLayers { uvec2 viewLayers[]; };  // first layer, number of layers

void main() {
  int slot = int(listIndex()), slotsOfView = depthLayers * normalLayers, slots = viewCount * slotsOfView;
  if (slot >= slots) return;
  uint number = numbers[slot], next = slot + 1 < slots ? numbers[slot + 1] : total;
  int view = slot / slotsOfView;
  if (slot % slotsOfView == 0) {
    int following = slot + slotsOfView;
    viewLayers[view] = uvec2(number, (following < slots ? numbers[following] : total) - number);
  }
  if (next == number) return;
  int bound = view * (depthLayers + 1) + slot % slotsOfView / normalLayers;
  float low = bounds[bound], high = bounds[bound + 1], middle = 0.5 * (low + high);
  // An interval may be a single depth, which is rounded.
  const float kLeast = 1e-5;
  layers[number] = Layer(middle, max(0.5 * (high - low), kLeast * max(abs(middle), 1e-3)), view,
                         normalLayers > 1 ? slot % normalLayers : -1, slot);
}
