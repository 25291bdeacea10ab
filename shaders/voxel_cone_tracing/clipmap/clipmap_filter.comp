#version 450
// Filters the voxels of a level of a clipmap from the finer level, by the rule of filter_directional.comp, for the voxels that
// clipmap_anew.comp has listed. In a level around the camera, the result is blended with the voxelized values by a ramp of the distance
// from the border of the finer level (thesis 004 Sec. 3.5.2), so that an object that enters the finer level does not jump. In a level above
// (ABOVE), all voxels are filtered.
#pragma lumivox axis ABOVE 0 1
layout(local_size_x = 64) in;
#include "common/cones.glsl"
#include "common/voxel.glsl"
#include "clipmap_write.glsl"
#include "clipmap_children.glsl"
#include "clipmap_ramp.glsl"
#include "clipmap_items.glsl"

layout(std140, binding = 0) uniform Level {
  ivec3 firstMade;  // origin of the voxel coordinates in items
  int level;
};
// Named by the outward normals of the faces.
layout(binding = 0) uniform sampler3D positiveX;
layout(binding = 1) uniform sampler3D negativeX;
layout(binding = 2) uniform sampler3D positiveY;
layout(binding = 3) uniform sampler3D negativeY;
layout(binding = 4) uniform sampler3D positiveZ;
layout(binding = 5) uniform sampler3D negativeZ;

// Texels of the children, with x fastest, and bits of those that are occupied.
struct Children {
  ivec3 texels[8];
  uint occupied;
};
Children childrenOf(int finer, ivec3 voxel) {
  LevelBlocks blocks = blocksOf(finer);
  Children result;
  result.occupied = 0u;
  for (int i = 0; i < 8; ++i) {
    ivec3 child = childOf(voxel, i);
    result.texels[i] = ivec3(0);
    if (!isOfLevel(blocks, child)) continue;
    ClipmapPlace place = readPlace(blocks, child);
    if (!isOccupied(place)) continue;
    result.occupied |= 1u << i;
    result.texels[i] = place.texel;
  }
  return result;
}

// A face of a coarse voxel by the rule of columns.glsl, for eight whole children: the mean over four columns of two children along an axis.
// `along`, `side`, `up`: index steps of the children along this axis and the two others. The second child of a column, `along` after the
// first, is in front if the column is seen from the higher side.
vec4 seenThrough(sampler3D face, Children children, int along, int side, int up, bool fromHigher) {
  vec4 values[8];
  for (int i = 0; i < 8; ++i) {
    values[i] = vec4(0.0);
    if ((children.occupied >> i & 1u) != 0u) values[i] = texelFetch(face, children.texels[i], 0);
  }
  vec4 sum = vec4(0.0);
  for (int column = 0; column < 4; ++column) {
    int first = (column & 1) * side + (column >> 1) * up;
    sum += fromHigher ? over(values[first + along], values[first]) : over(values[first], values[first + along]);
  }
  return sum / 4.0;
}

void make(ivec3 voxel) {
#if ABOVE
  bool isVoxel = all(lessThan(voxel, ownEnd[level].xyz));
  ClipmapPlace place = ownPlace(level, voxel);
  float share = 1.0;
#else
  bool isVoxel = all(lessThan(voxel, innerEnd[level].xyz));
  ClipmapPlace place = innerPlace(level, voxel), own = ownPlace(level, voxel);
  float share = shareOfFiner(endsOf(level - 1), voxel);
#endif
  Children children;
  children.occupied = 0u;
  if (isVoxel && share > 0.0) children = childrenOf(level - 1, voxel);
  bool occupied = children.occupied != 0u;
  vec4 faces[6] = vec4[6](vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0));
  if (occupied)
    faces = vec4[6](seenThrough(positiveX, children, 1, 2, 4, true), seenThrough(negativeX, children, 1, 2, 4, false),
                    seenThrough(positiveY, children, 2, 4, 1, true), seenThrough(negativeY, children, 2, 4, 1, false),
                    seenThrough(positiveZ, children, 4, 1, 2, true), seenThrough(negativeZ, children, 4, 1, 2, false));
#if !ABOVE
  bool voxelized = isVoxel && share < 1.0 && isOccupied(own);
  occupied = occupied || voxelized;
  vec4 before[6] = vec4[6](vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0));
  if (voxelized)
    before = vec4[6](texelFetch(positiveX, own.texel, 0), texelFetch(negativeX, own.texel, 0), texelFetch(positiveY, own.texel, 0),
                     texelFetch(negativeY, own.texel, 0), texelFetch(positiveZ, own.texel, 0), texelFetch(negativeZ, own.texel, 0));
  for (int face = 0; face < 6; ++face) faces[face] = mix(before[face], faces[face], share);
#endif
  writeVoxel(place, faces, occupied);
}

void main() {
  uint count = heads[level].count;
  for (uint i = gl_WorkGroupID.x * kItemGroup + gl_LocalInvocationID.x; i < count; i += gl_NumWorkGroups.x * kItemGroup)
    make(firstMade + unpackVoxel(items[i]));
}
