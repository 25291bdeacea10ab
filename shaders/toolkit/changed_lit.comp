#version 450
// Finds the cells to which light may come otherwise: those that lie in a shadow view behind something that moves. A cell that is found is
// lit again and nothing else, so that it does no harm to find too many.
layout(local_size_x = 64) in;
#include "common/list.glsl"
#define CHANGES_BUILD
#include "changed_cells.glsl"
#include "shadowed_anew.glsl"

layout(std140, binding = 0) uniform Cells {
  vec3 gridLow;   // m
  float cellSize; // m
  int boxCount;
  int lightCount;
  float texel;    // of the shadow views, in clip space
};
layout(std430, binding = 2) readonly buffer CellEnds { uint cellEnds[]; };

void main() {
  uint cell = listIndex();
  if (cell >= 1u << 3 * cellDepth || cellEnds[cell] == (cell > 0u ? cellEnds[cell - 1u] : 0u)) return;  // or nothing static is there
  vec3 low = gridLow + cellSize * vec3(placeOf(cell));
  if (isShadowedAnew(low, low + cellSize, lightCount, boxCount, texel)) setChanged(cell);
}
