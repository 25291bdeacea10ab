// The fragment of a triangle in the voxels of a column; the same to the bit for every voxelizer that works by columns.
#ifndef LUMIVOX_COLUMN_SAMPLE
#define LUMIVOX_COLUMN_SAMPLE
#include "common/textures.glsl"
#include "common/triangle.glsl"

// If the triangle does not cover a column's centre, the distance of the sample inside the edge, in voxels. On the edge itself, where the
// next surface begins, rounding would decide whether light reaches it.
const float kInset = 1.0 / 64.0;

// Barycentric coordinates in the projection of the point of the triangle nearest to a point, or just inside of it.
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

// The sample of the triangle in a column: the fragment of every voxel there, but for its place.
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
  fragment.emission = packShared(material.emission.rgb);
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
  // A column is a voxel wide: the gradients of the affine map select the mip that averages over a voxel.
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

// Whether the mask removes all of the triangle there.
bool isHole(ColumnSample s) { return s.fragment.albedoBCoverage >> 16 == 0u; }

// A point of the triangle in a voxel of the column, from its corner. Where the sample lies in another voxel than this one it goes along the
// triangle to this one's depth: only moved in depth it would lie off the triangle, and in its shadow. The axis of the columns is that which
// the triangle faces most, so that the way through the voxel is no longer than half of it along each axis.
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
