#version 450
// Collects both sides of the surfaces in the voxels of the cells in front of them. STEP weigh: the weights, which are the denominators of
// the means; STEP add: the means, the covered parts and the albedo with the largest contrast.
#pragma lumivox axis STEP weigh add
#include "lit_voxel.glsl"
#include "beside_walls.glsl"
#if STEP == STEP_WEIGH
#define MARKS_BRICKS
#include "bricks.glsl"
#endif

layout(local_size_x = 64) in;
#include "common/fragments.glsl"

layout(std140, binding = 0) uniform Parameters {
  vec3 listLow;      // low corner of the grid of the fragments, m
  float listVoxel;   // m
  int twoSided;
};
#include "cell_grid.glsl"
layout(binding = 5) uniform sampler3D occluded;

// Listing 4.27: the contrast of a colour in 7 bits, then the colour in 8 bits per channel.
uint packWinner(vec3 albedo) {
  uvec3 colour = uvec3(clamp(albedo, 0.0, 1.0) * 255.0 + 0.5);
  return 1u << 31 | uint(contrastOf(albedo) * 127.0) << 24 | colour.r << 16 | colour.g << 8 | colour.b;
}

void add(ivec3 cell, vec3 position, vec3 normal, vec3 albedo, uint parts) {
  if (parts == 0u || any(lessThan(cell, ivec3(0))) || any(greaterThanEqual(cell, resolution))) return;
  int voxel = (cell.z * resolution.y + cell.y) * resolution.x + cell.x, group = groupOf(normal);
  uint weight = uint(bitCount(parts));
#if STEP == STEP_WEIGH
  if (atomicAdd(voxels[voxel].weight, weight) == 0u) markBrick(cell, resolution);
  atomicAdd(voxels[voxel].groups[group].weight, weight);
#else
  float ofVoxel = float(voxels[voxel].weight) / float(weight);
  float ofGroup = float(voxels[voxel].groups[group].weight) / float(weight);
  vec3 offset = clamp((position - vec3(cell) - 0.5) / kPositionRange, -1.0, 1.0);
  for (int i = 0; i < 3; ++i) {
    atomicAdd(voxels[voxel].albedo[i], signedShareOf(albedo[i] * (1.0 / ofVoxel)));
    atomicAdd(voxels[voxel].groups[group].normal[i], signedShareOf(normal[i] * (1.0 / ofGroup)));
    atomicAdd(voxels[voxel].groups[group].position[i], signedShareOf(offset[i] * (1.0 / ofGroup)));
  }
  atomicOr(voxels[voxel].groups[group].parts, parts);
  atomicMax(voxels[voxel].winner, packWinner(albedo));
#endif
}

// Whether a surface with its centre in the cell `home` ends at a wall before it reaches a column along the axis.
bool endsBefore(ivec3 home, int axis, int column) {
  if (column == home[axis]) return false;
  ivec3 face = home;
  if (column > home[axis]) ++face[axis];
  return texelFetch(occluded, clamp(face, ivec3(0), resolution), 0)[axis] > 0.5;
}

void main() {
  uint index = listIndex();
  if (index >= fragmentCount) return;
  VoxelFragment fragment = fragments[index];
  vec2 blueCoverage = unpackHalf2x16(fragment.albedoBCoverage);
  vec3 albedo = clamp(vec3(unpackHalf2x16(fragment.albedoRg), blueCoverage.x), 0.0, 1.0);
  vec3 position = (listLow + (vec3(unpackVoxel(fragment.voxel)) + unpackOffset(fragment.offset)) * listVoxel - gridLow) / cellSize;
  vec3 front = unpackNormal(fragment.normal);
  uint allowed = allowedParts(blueCoverage.y);
  int axis = dominantAxis(front), u = (axis + 1) % 3, v = (axis + 2) % 3;
  ivec2 first, last;
  if (!partRange(vec2(position[u], position[v]), vec2(listVoxel / cellSize), first, last)) return;
  for (int sideOf = 0; sideOf < (twoSided != 0 ? 2 : 1); ++sideOf) {
    vec3 normal = sideOf == 0 ? front : -front;
    ivec3 home = besideWalls(cellInFront(position, normal), position, axis);
    for (int cellV = cellOfPart(first.y); cellV <= cellOfPart(last.y); ++cellV)
      for (int cellU = cellOfPart(first.x); cellU <= cellOfPart(last.x); ++cellU) {
        ivec2 column = ivec2(cellU, cellV);
        uint parts = partsInCell(first, last, column) & allowed;
        ivec3 cell = home;
        cell[u] = cellU;
        cell[v] = cellV;
        // Parts in front of the true position of a moved wall belong to the cell in front of the wall. Parts beyond the wall do not exist:
        // a fragment is as large as its voxel, even if its surface ends earlier.
        vec3 middle = position;
        middle[u] = 0.5 * float(max(first.x, kParts * cellU) + min(last.x, kParts * cellU + kParts - 1) + 1) / float(kParts);
        middle[v] = 0.5 * float(max(first.y, kParts * cellV) + min(last.y, kParts * cellV + kParts - 1) + 1) / float(kParts);
        ivec3 beside = besideWalls(cell, middle, axis);
        if (endsBefore(home, u, beside[u]) || endsBefore(home, v, beside[v])) continue;
        add(beside, position, normal, albedo, beside == cell ? parts : parts << kBesideParts);
      }
  }
}
