#version 450
// Occlusion: the parts of each face between two cells that surfaces cover.
// Deviates from Kaplanyan & Dachsbacher 2010, Sec. 4.2 and thesis 004 Listing 4.33, where a cosine lobe around a normal occludes: here each
// surface is moved to the nearest plane of faces, and its projection covers some of the 4 x 4 parts of a face. Parts are combined by OR,
// so that overlapping triangles do not count twice and the order does not matter.
#include "parts.glsl"
#define MARKS_BRICKS
#include "bricks.glsl"

layout(local_size_x = 64) in;
#include "common/fragments.glsl"

layout(std140, binding = 0) uniform Parameters {
  vec3 listLow;       // low corner of the grid of the fragments, m
  float listVoxel;    // m
};
#include "cell_grid.glsl"
// For each axis, parts of the face towards the lower neighbour.
layout(binding = 0, r32ui) uniform uimage3D partsX;
layout(binding = 1, r32ui) uniform uimage3D partsY;
layout(binding = 2, r32ui) uniform uimage3D partsZ;

void mark(int axis, ivec3 face, uint parts) {
  if (parts == 0u || any(lessThan(face, ivec3(0))) || any(greaterThanEqual(face, resolution))) return;
  uint before;
  if (axis == 0) before = imageAtomicOr(partsX, face, parts);
  else if (axis == 1) before = imageAtomicOr(partsY, face, parts);
  else before = imageAtomicOr(partsZ, face, parts);
  if (before == 0u) markBrick(face, resolution);
}

void main() {
  uint index = listIndex();
  if (index >= fragmentCount) return;
  VoxelFragment fragment = fragments[index];
  vec3 position = (listLow + (vec3(unpackVoxel(fragment.voxel)) + unpackOffset(fragment.offset)) * listVoxel - gridLow) / cellSize;
  vec3 front = unpackNormal(fragment.normal), normal = abs(front);
  int dominant = dominantAxis(normal);
  float slope = (normal.x + normal.y + normal.z) / normal[dominant] - 1.0;
  uint facing = facingBits(position[dominant], front[dominant], 0.5 * slope * listVoxel / cellSize);
  uint allowed = allowedParts(unpackHalf2x16(fragment.albedoBCoverage).y);

  for (int axis = 0; axis < 3; ++axis) {
    // The fragment covers one column of its grid along the dominant axis. Projected along another axis,
    // its height is the slope of the surface.
    int u = (axis + 1) % 3, v = (axis + 2) % 3;
    vec2 size = vec2(listVoxel / cellSize);
    if (u == dominant) size.x *= normal[axis] / normal[dominant];
    if (v == dominant) size.y *= normal[axis] / normal[dominant];
    ivec2 first, last;
    if (!partRange(vec2(position[u], position[v]), size, first, last)) continue;
    ivec3 face;
    face[axis] = planeOf(position[axis]);
    for (int cellV = cellOfPart(first.y); cellV <= cellOfPart(last.y); ++cellV)
      for (int cellU = cellOfPart(first.x); cellU <= cellOfPart(last.x); ++cellU) {
        face[u] = cellU;
        face[v] = cellV;
        uint parts = partsInCell(first, last, ivec2(cellU, cellV)) & allowed;
        if (parts != 0u && axis == dominant) parts |= facing;
        mark(axis, face, parts);
      }
  }
}
