#version 450
// Appends one fragment per triangle and voxel that it touches to a list (Crassin & Green 2012, Sec. 22.3.2; thesis 004 Listing 4.4).
// Deviates: the exact overlap test of triangle.glsl decides which voxels are touched, instead of the bounding box of the thesis.
#pragma lumivox axis TEXTURES 0 1
#pragma lumivox axis MASKS 0 1
#define SCENE_MATERIALS
#include "common/scene.glsl"
#include "fragment_list.glsl"

// 1: every voxel of the column that the triangle touches; 0: only the voxel that contains the triangle at the column's centre.
layout(constant_id = 0) const int depthRange = 1;

#include "common/column_sample.glsl"

layout(location = 0) flat in mat3 corners;
layout(location = 3) flat in mat3 cornerNormals;
layout(location = 6) flat in int dominantAxis;
#if TEXTURES || MASKS
layout(location = 7) flat in vec2 cornerTexcoords[3];
#else
const vec2 cornerTexcoords[3] = vec2[3](vec2(0.0), vec2(0.0), vec2(0.0));
#endif

void main() {
  ivec2 column = ivec2(gl_FragCoord.xy);
  Overlap o = overlapOf(corners, permute(resolution, dominantAxis));
  if (any(lessThan(column, o.low.xy)) || any(greaterThan(column, o.high.xy)) || !touchesColumn(o, column)) discard;
  MaterialData material = materials[materialIndex];
  ColumnSample s = sampleColumn(corners, cornerNormals, cornerTexcoords, material, fragmentOf(material), column);
  if (isHole(s)) discard;
  ivec2 depths = depthsOfColumn(o, corners, column);
  for (int depth = depths.x; depth <= depths.y; ++depth) {
    ivec3 voxel = ivec3(column, depth);
    if ((depthRange == 0 && depth != int(floor(s.centre.z))) || !touchesInColumn(o, voxel)) continue;
    uint index = atomicAdd(fragmentCount, 1u);
    if (index < uint(capacity)) fragments[index] = fragmentAt(s, voxel, dominantAxis);
  }
}
