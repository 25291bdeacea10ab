#version 450
// Closes the slits where two surfaces meet: each ends at the true position of the other, which was moved to a plane of faces up to half a
// cell away, so that a slit would stay open along every inner edge of a closed room. A surface that reaches past the middle of a cell's
// face is extended to the surface that closes the cell at that side. The pass runs twice, so that corners of three surfaces are closed too.
// Only surfaces that mostly face the axis of their faces count: the steps of one slanted surface are no corners.
#include "parts.glsl"
#include "bricks.glsl"

layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(binding = 0, r32ui) uniform readonly uimage3D partsX;
layout(binding = 1, r32ui) uniform readonly uimage3D partsY;
layout(binding = 2, r32ui) uniform readonly uimage3D partsZ;
layout(binding = 3, r32ui) uniform writeonly uimage3D filledX;
layout(binding = 4, r32ui) uniform writeonly uimage3D filledY;
layout(binding = 5, r32ui) uniform writeonly uimage3D filledZ;

// The 4 x 4 parts of a face, u along the next axis, v along the axis after it. Outside the grid no part is covered.
uint partsOf(int axis, ivec3 face) {
  if (any(lessThan(face, ivec3(0))) || any(greaterThanEqual(face, imageSize(partsX)))) return 0u;
  return axis == 0 ? imageLoad(partsX, face).r : axis == 1 ? imageLoad(partsY, face).r : imageLoad(partsZ, face).r;
}
uint bitAt(int u, int v) { return 1u << (4 * v + u); }
bool has(uint parts, int u, int v) { return (parts & bitAt(u, v)) != 0u; }

uint filled(int axis, ivec3 face) {
  uint parts = partsOf(axis, face), result = parts;
  if ((parts & kFacing) == 0u || (parts & kPartsMask) == kPartsMask) return parts;
  for (int lateral = 1; lateral <= 2; ++lateral) {
    int across = (axis + lateral) % 3;
    for (int side = 0; side < 2; ++side) {
      // The faces at this side of the two cells that share the face.
      ivec3 upper = face, lower;
      upper[across] += side;
      lower = upper;
      lower[axis] -= 1;
      uint ofUpper = partsOf(across, upper), ofLower = partsOf(across, lower);
      if (((ofUpper | ofLower) & kFacing) == 0u) continue;
      int inner = side == 1 ? 1 : 2, outer = side == 1 ? 2 : 0;  // the part before the middle; the first of the two parts beyond it
      for (int along = 0; along < 4; ++along) {
        bool reaches = lateral == 1 ? has(parts, inner, along) : has(parts, along, inner);
        // The other surfaces end at this surface too, but not before the middle of their cell.
        bool meets = lateral == 1 ? has(ofLower, along, 1) || has(ofUpper, along, 2) : has(ofLower, 1, along) || has(ofUpper, 2, along);
        if (reaches && meets)
          result |= lateral == 1 ? bitAt(outer, along) | bitAt(outer + 1, along) : bitAt(along, outer) | bitAt(along, outer + 1);
      }
    }
  }
  return result;
}

void main() {
  ivec3 face = listedCell();
  if (any(greaterThanEqual(face, imageSize(partsX)))) return;
  imageStore(filledX, face, uvec4(filled(0, face)));
  imageStore(filledY, face, uvec4(filled(1, face)));
  imageStore(filledZ, face, uvec4(filled(2, face)));
}
