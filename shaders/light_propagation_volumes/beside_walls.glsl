// Cells of surface points beside walls that were moved to a plane of cell faces. A floor ends at the true position of a wall, at most half
// a cell behind the plane; the strip between plane and wall belongs to the cell in front of the plane.
#include "parts.glsl"

layout(binding = 4) uniform sampler3D moved;

// How far the surfaces on a face that hide a point beyond the face were moved, in steps.
int movedSteps(ivec3 face, int axis, bool above) {
  if (any(lessThan(face, ivec3(0))) || any(greaterThanEqual(face, textureSize(moved, 0)))) return 0;
  int steps = int(texelFetch(moved, face, 0)[axis] * 255.0 + 0.5);
  return above ? steps & 15 : steps >> 4;
}

// The cell of a surface point, given the cell in front of its surface, which mostly faces the axis
// `dominant`: moved in front of walls beside it.
ivec3 besideWalls(ivec3 cell, vec3 position, int dominant) {
  for (int i = 1; i <= 2; ++i) {
    int axis = (dominant + i) % 3;
    int plane = planeOf(position[axis]);
    float beyond = position[axis] - float(plane);
    ivec3 face = cell;
    face[axis] = plane;
    int steps = movedSteps(face, axis, beyond >= 0.0);
    // A slanted wall is moved further in the cell that contains the point itself.
    face[dominant] = int(floor(position[dominant]));
    steps = max(steps, movedSteps(face, axis, beyond >= 0.0));
    if (abs(beyond) * kMovedSteps < float(steps)) cell[axis] = beyond >= 0.0 ? plane - 1 : plane;
  }
  return cell;
}

// The cell of a surface point: in front of its surface, and in front of the walls beside it.
ivec3 cellBeside(vec3 position, vec3 normal) {
  const float kFragment = 0.25;  // cells from the centre of a fragment to its side
  int dominant = dominantAxis(normal);
  ivec3 cell = cellInFront(position, normal);
  // A fragment is moved as a whole: a slanted fragment may lie on the next plane, so that this cell would be behind it.
  bool isUp = normal[dominant] >= 0.0;
  ivec3 face = cell;
  if (isUp) ++face[dominant];
  float ahead = abs(float(face[dominant]) - position[dominant]);
  float slope = (abs(normal.x) + abs(normal.y) + abs(normal.z)) / abs(normal[dominant]) - 1.0;
  if ((ahead - kFragment * slope) * kMovedSteps < float(movedSteps(face, dominant, !isUp))) cell[dominant] += isUp ? 1 : -1;
  return besideWalls(cell, position, dominant);
}
