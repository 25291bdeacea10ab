// Cells of places beside walls that were moved to a plane of faces: a floor ends at the true place of a wall, half a cell behind the plane at
// most, and what lies between belongs to the cell in front of the plane.
#include "parts.glsl"

layout(binding = 4) uniform sampler3D moved;

// How far the surfaces on a face were moved that hide a place beyond it, steps.
int movedSteps(ivec3 face, int axis, bool above) {
  if (any(lessThan(face, ivec3(0))) || any(greaterThanEqual(face, textureSize(moved, 0)))) return 0;
  int steps = int(texelFetch(moved, face, 0)[axis] * 255.0 + 0.5);
  return above ? steps & 15 : steps >> 4;
}

// Of a place on a surface that mostly faces `dominant`, in the cell in front of that surface.
ivec3 besideWalls(ivec3 cell, vec3 position, int dominant) {
  for (int i = 1; i <= 2; ++i) {
    int axis = (dominant + i) % 3;
    int plane = planeOf(position[axis]);
    float beyond = position[axis] - float(plane);
    ivec3 face = cell;
    face[axis] = plane;
    int steps = movedSteps(face, axis, beyond >= 0.0);
    // A wall at a slant is moved by more in the cell where the place truly is.
    face[dominant] = int(floor(position[dominant]));
    steps = max(steps, movedSteps(face, axis, beyond >= 0.0));
    if (abs(beyond) * kMovedSteps < float(steps)) cell[axis] = beyond >= 0.0 ? plane - 1 : plane;
  }
  return cell;
}

// Of a place on a surface: in front of it, and of the walls beside it.
ivec3 cellBeside(vec3 position, vec3 normal) {
  const float kFragment = 0.25;  // cells from the middle of a fragment to its side
  int dominant = dominantAxis(normal);
  ivec3 cell = cellInFront(position, normal);
  // A fragment is moved as a whole. One at a slant may have gone on to the next plane with all that it covers, and this cell is behind it.
  bool isUp = normal[dominant] >= 0.0;
  ivec3 face = cell;
  if (isUp) ++face[dominant];
  float ahead = abs(float(face[dominant]) - position[dominant]);
  float slope = (abs(normal.x) + abs(normal.y) + abs(normal.z)) / abs(normal[dominant]) - 1.0;
  if ((ahead - kFragment * slope) * kMovedSteps < float(movedSteps(face, dominant, !isUp))) cell[dominant] += isUp ? 1 : -1;
  return besideWalls(cell, position, dominant);
}
