#version 450
// The voxels of a level of a clipmap that the finer one has too, as filter_directional.comp makes coarser levels: those of a level around the
// camera, blended with what was voxelized by a ramp of the distance from the border of the finer level (thesis 004 Sec. 3.5.2), so that a
// thing that comes into the finer level does not change by a leap; or all of a level above those.
#pragma lumivox axis ABOVE 0 1
layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;
#include "clipmap_write.glsl"

layout(std140, binding = 0) uniform Level {
  int level;  // that is made
};
// By the outward normals of the faces.
layout(binding = 0) uniform sampler3D positiveX;
layout(binding = 1) uniform sampler3D negativeX;
layout(binding = 2) uniform sampler3D positiveY;
layout(binding = 3) uniform sampler3D negativeY;
layout(binding = 4) uniform sampler3D positiveZ;
layout(binding = 5) uniform sampler3D negativeZ;

// Texels of the children, x first, and which of them are not empty.
ivec3 childTexel[8];
uint occupiedChildren = 0u;
ivec3 firstChild;

vec4 higherFace(int axis, ivec3 child) {
  ivec3 at = child - firstChild;
  int index = at.x | at.y << 1 | at.z << 2;
  if ((occupiedChildren >> index & 1u) == 0u) return vec4(0.0);
  ivec3 texel = childTexel[index];
  return axis == 0 ? texelFetch(positiveX, texel, 0) : axis == 1 ? texelFetch(positiveY, texel, 0) : texelFetch(positiveZ, texel, 0);
}
vec4 lowerFace(int axis, ivec3 child) {
  ivec3 at = child - firstChild;
  int index = at.x | at.y << 1 | at.z << 2;
  if ((occupiedChildren >> index & 1u) == 0u) return vec4(0.0);
  ivec3 texel = childTexel[index];
  return axis == 0 ? texelFetch(negativeX, texel, 0) : axis == 1 ? texelFetch(negativeY, texel, 0) : texelFetch(negativeZ, texel, 0);
}
#include "columns.glsl"

void findChildren(int finer, ivec3 voxel) {
  firstChild = 2 * voxel;
  for (int i = 0; i < 8; ++i) {
    ivec3 child = firstChild + ivec3(i & 1, i >> 1 & 1, i >> 2);
    // A voxel at the border of the coarsest level may reach beyond it.
    if (any(lessThan(child, ownFirst[finer].xyz)) || any(greaterThanEqual(child, ownEnd[finer].xyz))) continue;
    ClipmapPlace place = isInner(finer, child) ? innerPlace(finer, child) : ownPlace(finer, child);
    if (!isOccupied(place)) continue;
    occupiedChildren |= 1u << i;
    childTexel[i] = place.texel;
  }
}

void main() {
  // All addresses of the block: those that hold no voxel now are emptied.
  ivec3 item = ivec3(gl_GlobalInvocationID);
#if ABOVE
  if (any(greaterThanEqual(item, ivec3(ownFirst[level].w)))) return;
  ivec3 voxel = ownFirst[level].xyz + item;
  bool isVoxel = all(lessThan(voxel, ownEnd[level].xyz));
  ClipmapPlace place = ownPlace(level, voxel);
#else
  if (any(greaterThanEqual(item, ivec3(innerFirst[level].w)))) return;
  ivec3 voxel = innerFirst[level].xyz + item;
  bool isVoxel = all(lessThan(voxel, innerEnd[level].xyz));
  ClipmapPlace place = innerPlace(level, voxel), own = ownPlace(level, voxel);
#endif
  if (isVoxel) findChildren(level - 1, voxel);
  bool occupied = occupiedChildren != 0u;
#if !ABOVE
  // Where the finer level begins, nothing is of it: reading goes on there without a leap.
  float fromBorder = 0.5 * withinReach(level - 1, 2.0 * (vec3(voxel) + 0.5));
  float share = clamp((fromBorder - 1.0) / max(clipmapRamp, 1e-6), 0.0, 1.0);
  bool voxelized = isVoxel && share < 1.0 && isOccupied(own);
  occupied = occupied || voxelized;
#endif
  if (!occupied && !isOccupied(place)) return;
  vec4 faces[6] = vec4[6](vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0));
  if (occupiedChildren != 0u)
    for (int axis = 0; axis < 3; ++axis)
      lookThrough(voxel, axis, firstChild, firstChild + 1, vec3(2.0), faces[2 * axis], faces[2 * axis + 1]);
#if !ABOVE
  vec4 before[6] = vec4[6](vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0));
  if (voxelized)
    before = vec4[6](texelFetch(positiveX, own.texel, 0), texelFetch(negativeX, own.texel, 0), texelFetch(positiveY, own.texel, 0),
                     texelFetch(negativeY, own.texel, 0), texelFetch(positiveZ, own.texel, 0), texelFetch(negativeZ, own.texel, 0));
  for (int face = 0; face < 6; ++face) faces[face] = mix(before[face], faces[face], share);
#endif
  writeVoxel(place, faces, occupied);
}
