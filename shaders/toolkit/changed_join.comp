#version 450
// Adds the changed cells of another frame to those of this one.
layout(local_size_x = 64) in;
#include "common/list.glsl"
#define CHANGES_BUILD
#include "changed_cells.glsl"

layout(std430, binding = 2) readonly buffer OtherCells { uint otherCells[]; };

void main() {
  uint word = listIndex();
  if (word < firstWord(cellDepth + 1)) changedCells[word] |= otherCells[word];
}
