// Surfaces on the faces of cells: each face has 4 x 4 parts, one bit each. The bits above describe the surfaces that mostly face the axis.
// One bit: there is such a surface. Seven bits each, for surfaces that face down and up the axis: how far they were moved to lie on the
// face. Bit k of the first seven is set for a true position from k/14 to (k+1)/14 of a cell above the plane; bit k of the others for a
// position below. The space between the plane and the true position is in front of the surface, but in the cell behind it.
#ifndef LUMIVOX_PARTS
#define LUMIVOX_PARTS
#include "common/voxel.glsl"

const int kParts = 4;  // along a side of a face

// Ordered thresholds of the parts (Bayer 1973), so that a surface with holes covers its share of each face.
const int kThreshold[16] = int[16](0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5);

const uint kPartsMask = 0xffffu;
const int kMovedDown = 16, kMovedUp = 23;  // the first bits
const uint kMovedMask = 0x7fu, kFacing = 1u << 30;
const float kMovedSteps = 14.0;  // per cell

// The plane of faces to which a surface at this position along an axis is moved: the nearest plane. Half-way between two planes, rounding
// could decide differently for each fragment, virtual light and receiver: all are moved up.
int planeOf(float position) {
  const float kRounding = 0.01;  // cells
  return int(floor(position + 0.5 + kRounding));
}

// The bits above the parts, for a surface whose position along its dominant axis varies by `slant` to both sides.
uint facingBits(float position, float normal, float slant) {
  float beyond = position - float(planeOf(position));
  float moved = (normal < 0.0 ? beyond : -beyond) + slant;
  if (moved <= 0.0) return kFacing;  // moved away from the space in front of it
  int step = min(int(moved * kMovedSteps), 6);
  return kFacing | 1u << ((normal < 0.0 ? kMovedDown : kMovedUp) + step);
}

int dominantAxis(vec3 normal) {
  vec3 size = abs(normal);
  return size.x > size.y && size.x > size.z ? 0 : size.y > size.z ? 1 : 2;
}

// The cell in front of a surface after the surface was moved to the nearest plane of faces along the dominant axis of its normal. Its light
// starts there, never inside its own object (Kaplanyan & Dachsbacher 2010, Sec. 4.1, move the light by half a cell along the normal).
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

// The parts whose centres lie in a rectangle on the plane of faces, in cells; false if there are none. Rectangles that tile the plane
// cover every part exactly once.
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
