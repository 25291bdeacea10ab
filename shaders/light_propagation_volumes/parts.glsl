// Surfaces on the faces of cells: each face has 4 x 4 parts, one bit each. Above them, of the surfaces that mostly face the axis: whether
// there is one, and, seven bits each, how far those that look down and up the axis were moved to come to lie on the face: bit k of the first
// for a true place of k/14 to (k+1)/14 of a cell above the plane, and of the second below it. What lies between the plane and the true
// place is in front of the surface, and yet in the cell behind it.
#ifndef LUMIVOX_PARTS
#define LUMIVOX_PARTS
#include "common/voxel.glsl"

const int kParts = 4;  // along a side of a face

// Ordered thresholds of the parts (Bayer 1973), so that a surface with holes covers its share of each face.
const int kThreshold[16] = int[16](0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5);

const uint kPartsMask = 0xffffu;
const int kMovedDown = 16, kMovedUp = 23;  // the first bits
const uint kMovedMask = 0x7fu, kFacing = 1u << 30;
const float kMovedSteps = 14.0;  // a cell

// The plane of faces that a surface at this place along an axis is moved to, the nearest one. Half-way between two of them rounding would
// decide for every fragment, virtual light and receiver apart: they all go up.
int planeOf(float position) {
  const float kRounding = 0.01;  // cells
  return int(floor(position + 0.5 + kRounding));
}

// The bits above the parts, of a surface whose place along the axis that it mostly faces varies by `slant` to both sides.
uint facingBits(float position, float normal, float slant) {
  float beyond = position - float(planeOf(position));
  float moved = (normal < 0.0 ? beyond : -beyond) + slant;
  if (moved <= 0.0) return kFacing;  // away from what is in front of it
  int step = min(int(moved * kMovedSteps), 6);
  return kFacing | 1u << ((normal < 0.0 ? kMovedDown : kMovedUp) + step);
}

int dominantAxis(vec3 normal) {
  vec3 size = abs(normal);
  return size.x > size.y && size.x > size.z ? 0 : size.y > size.z ? 1 : 2;
}

// The cell in front of a surface after it was moved to the nearest plane of faces along the dominant axis of its normal: where its light
// starts, never inside what it lies on (Kaplanyan & Dachsbacher 2010, Sec. 4.1, move it by half a cell along the normal).
ivec3 cellInFront(vec3 position, vec3 normal) {
  int dominant = dominantAxis(normal);
  ivec3 cell = ivec3(floor(position));
  int plane = planeOf(position[dominant]);
  cell[dominant] = normal[dominant] >= 0.0 ? plane : plane - 1;
  return cell;
}

// Bits that a surface of this coverage may set.
uint allowedParts(float coverage) {
  uint allowed = 0u;
  for (int part = 0; part < kParts * kParts; ++part)
    if (coverage * 16.0 > float(kThreshold[part]) + 0.5) allowed |= 1u << part;
  return allowed;
}

// The parts whose centres lie in a rectangle on the plane of faces, in cells; false when there are none. Rectangles that tile the plane
// share no part and leave none out.
bool partRange(vec2 centre, vec2 size, out ivec2 first, out ivec2 last) {
  first = ivec2(ceil((centre - 0.5 * size) * float(kParts) - 0.5));
  last = ivec2(ceil((centre + 0.5 * size) * float(kParts) - 0.5)) - 1;
  return all(lessThanEqual(first, last));
}

int cellOfPart(int part) { return part >> 2; }  // an arithmetic shift rounds down

uint partsInCell(ivec2 first, ivec2 last, ivec2 cell) {
  uint parts = 0u;
  for (int v = max(first.y, kParts * cell.y); v <= min(last.y, kParts * cell.y + kParts - 1); ++v)
    for (int u = max(first.x, kParts * cell.x); u <= min(last.x, kParts * cell.x + kParts - 1); ++u)
      parts |= 1u << (kParts * (v & 3) + (u & 3));
  return parts;
}
#endif
