// The fragment of a triangle in the voxels of a column, equal to the bit in every voxelizer that works by columns.
#ifndef LUMIVOX_COLUMN_SAMPLE
#define LUMIVOX_COLUMN_SAMPLE
#include "common/textures.glsl"
#include "common/triangle.glsl"

// Distance of the sample inside the triangle's edge, in voxels, if the triangle does not cover the column's centre. On the edge itself,
// where the next surface begins, rounding would decide whether light reaches the sample.
const float kInset = 1.0 / 64.0;

// Barycentric coordinates, in the projection along z, of the triangle's point nearest to a point; on an edge, moved inside by kInset.
vec3 barycentric(mat3 corners, vec2 point) {
  vec2 e1 = corners[1].xy - corners[0].xy, e2 = corners[2].xy - corners[0].xy, p = point - corners[0].xy;
  const vec3 kMiddle = vec3(1.0 / 3.0);
  float doubleArea = e1.x * e2.y - e1.y * e2.x;
  if (doubleArea == 0.0) return kMiddle;
  vec2 weights = vec2(p.x * e2.y - p.y * e2.x, e1.x * p.y - e1.y * p.x) / doubleArea;
  vec3 result = vec3(1.0 - weights.x - weights.y, weights);
  if (all(greaterThanEqual(result, vec3(0.0)))) return result;
  result = max(result, 0.0);
  result /= result.x + result.y + result.z;
  float toMiddle = length((corners * (kMiddle - result)).xy);
  return mix(result, kMiddle, toMiddle > kInset ? kInset / toMiddle : 1.0);
}

// The sample of the triangle in a column: the fragment that all voxels of the column share, without its position.
struct ColumnSample {
  mat3 corners;  // of the triangle
  vec3 centre;   // its point nearest to the middle of the column
  VoxelFragment fragment;
};

// The part that all fragments of a material share.
VoxelFragment fragmentOf(MaterialData material) {
  VoxelFragment fragment;
  fragment.voxel = fragment.offset = fragment.normal = 0u;
  fragment.albedoRg = packHalves(material.diffuse.rg);
  fragment.albedoBCoverage = packHalves(vec2(material.diffuse.b, 1.0));
  fragment.emission = packEmissionOrLobe(material.emission.rgb, material.specular);
  return fragment;
}

ColumnSample sampleColumn(mat3 corners, mat3 cornerNormals, vec2 cornerTexcoords[3], MaterialData material, VoxelFragment base, ivec2 column) {
  ColumnSample result;
  vec3 weights = barycentric(corners, vec2(column) + 0.5);
  result.corners = corners;
  result.centre = corners * weights;
  result.fragment = base;
#if TEXTURES || MASKS
  vec3 albedo = material.diffuse.rgb;
  float coverage = 1.0;
  vec2 texcoord = cornerTexcoords[0] * weights.x + cornerTexcoords[1] * weights.y + cornerTexcoords[2] * weights.z;
  // A column is one voxel wide: the gradients of the affine map select the mip level that averages over a voxel.
  vec2 e1 = corners[1].xy - corners[0].xy, e2 = corners[2].xy - corners[0].xy;
  vec2 t1 = cornerTexcoords[1] - cornerTexcoords[0], t2 = cornerTexcoords[2] - cornerTexcoords[0];
  float doubleArea = e1.x * e2.y - e1.y * e2.x;
  float inverse = doubleArea != 0.0 ? 1.0 / doubleArea : 0.0;
  vec2 gradientX = (t1 * e2.y - t2 * e1.y) * inverse, gradientY = (t2 * e1.x - t1 * e2.x) * inverse;
#if TEXTURES
  albedo *= textureGrad(diffuseTexture, texcoord, gradientX, gradientY).rgb;
#endif
#if MASKS
  coverage = textureGrad(maskTexture, texcoord, gradientX, gradientY).r;
#endif
  result.fragment.albedoRg = packHalves(albedo.rg);
  result.fragment.albedoBCoverage = packHalves(vec2(albedo.b, coverage));
#endif
  vec3 normal = cornerNormals * weights;
  result.fragment.normal = packNormal(dot(normal, normal) > 0.0 ? normalize(normal) : vec3(0.0, 1.0, 0.0));
  return result;
}

// Whether the mask removes the triangle everywhere in the column.
bool isHole(ColumnSample s) { return s.fragment.albedoBCoverage >> 16 == 0u; }

// A point of the triangle in a voxel of the column, relative to the voxel's corner. If the sample lies in another voxel of the column, it
// slides along the triangle to the depth of this voxel: moved in depth only, it would leave the triangle and lie in its shadow. Columns run
// along the dominant axis of the normal, so the sample moves by at most half a voxel along each axis.
vec3 placeIn(ColumnSample s, ivec3 voxel) {
  vec3 place = s.centre - vec3(voxel);
  float missing = clamp(place.z, 0.0, 1.0) - place.z;
  if (missing == 0.0) return place;
  vec3 facing = cross(s.corners[1] - s.corners[0], s.corners[2] - s.corners[0]);
  float slope = abs(facing.x) + abs(facing.y);
  if (slope == 0.0 || facing.z == 0.0) return place;
  vec2 way = sign(facing.xy) * (-missing * facing.z / slope);
  vec2 to = clamp(place.xy + way, 0.0, 1.0) + vec2(voxel.xy);
  return s.corners * barycentric(s.corners, to) - vec3(voxel);
}

VoxelFragment fragmentAt(ColumnSample s, ivec3 voxel, int axis) {
  VoxelFragment fragment = s.fragment;
  fragment.voxel = packVoxel(unpermute(voxel, axis));
  fragment.offset = packOffset(unpermute(placeIn(s, voxel), axis));
  return fragment;
}

#endif
