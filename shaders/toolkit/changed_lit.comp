#version 450
// Finds the cells whose direct light may change: those that lie behind a moving object in a shadow view. A cell found needlessly only costs
// being lit again, so the test is conservative.
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
  if (cell >= 1u << 3 * cellDepth || cellEnds[cell] == (cell > 0u ? cellEnds[cell - 1u] : 0u)) return;  // or no static fragment in it
  vec3 low = gridLow + cellSize * vec3(placeOf(cell));
  if (isShadowedAnew(low, low + cellSize, lightCount, boxCount, texel)) setChanged(cell);
}
