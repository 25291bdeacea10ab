#version 450
// One fragment per triangle and voxel that it touches, appended to a list (Crassin & Green 2012, Sec. 22.3.2; thesis 004 Listing 4.4).
// Which voxels: the exact triangle-box overlap of Schwarz & Seidel 2010, Sec. 3.1, in place of the bounding box of the thesis.
#pragma lumivox axis TEXTURES 0 1
#pragma lumivox axis MASKS 0 1
#define SCENE_MATERIALS
#include "common/scene.glsl"
#include "common/voxel.glsl"

layout(std140, binding = 1) uniform Grid {
  vec3 gridLow;
  float voxelSize;
  ivec3 resolution;
  int firstIndex;
  int capacity;
  int depthRange;
};

layout(std430, binding = 7) buffer Count { uint fragmentCount; };
layout(std430, binding = 8) writeonly buffer Fragments { VoxelFragment fragments[]; };
#if TEXTURES
layout(binding = 0) uniform sampler2D diffuseTexture;
#endif
#if MASKS
layout(binding = 1) uniform sampler2D maskTexture;
#endif

layout(location = 0) noperspective in vec2 plane;
layout(location = 1) flat in mat3 corners;
layout(location = 4) flat in mat3 cornerNormals;
layout(location = 7) flat in int dominantAxis;
#if TEXTURES || MASKS
layout(location = 8) flat in vec2 cornerTexcoords[3];
#endif

vec3 unpermute(vec3 v, int axis) { return axis == 0 ? v.zxy : axis == 1 ? v.yzx : v; }

// Rounding of float arithmetic, relative: what lies closer than this to touching counts as touching, so that no voxel is lost.
const float kRounding = 3e-7;

// Separating axis test of the projections of the triangle and of the box around `centre` on one coordinate plane: the axes are the normals
// of the three projected edges. Only intervals are compared, so that it does not matter how a sliver happens to be oriented.
bool overlap2d(vec2 a, vec2 b, vec2 c, vec2 centre) {
  vec2 corner[3] = vec2[3](a - centre, b - centre, c - centre);
  for (int i = 0; i < 3; ++i) {
    vec2 edge = corner[i == 2 ? 0 : i + 1] - corner[i];
    vec2 axis = vec2(-edge.y, edge.x);
    // Both ends of the edge project to one value.
    float onEdge = dot(axis, corner[i]), opposite = dot(axis, corner[i == 0 ? 2 : i - 1]);
    float reach = 0.5 * (abs(axis.x) + abs(axis.y));
    reach += kRounding * (abs(axis.x) + abs(axis.y)) * (abs(corner[i].x) + abs(corner[i].y) + 1.0);
    if (min(onEdge, opposite) > reach || max(onEdge, opposite) < -reach) return false;
  }
  return true;
}

// The thirteen axes of a triangle and a box (Schwarz & Seidel 2010, Sec. 3.1): three of the box, the plane, nine of the edges.
bool overlap(vec3 voxel, vec3 normal) {
  vec3 a = corners[0], b = corners[1], c = corners[2];
  if (any(greaterThan(min(a, min(b, c)), voxel + 1.0)) || any(lessThan(max(a, max(b, c)), voxel))) return false;
  vec3 centre = voxel + 0.5;
  // The normal of a needle is the small difference of large products: its rounding is that of the products.
  float rounding = kRounding * length(b - a) * length(c - a) * (length(centre - a) + 1.0);
  float reach = 0.5 * (abs(normal.x) + abs(normal.y) + abs(normal.z)) + rounding;
  if (abs(dot(normal, centre - a)) > reach) return false;
  return overlap2d(a.xy, b.xy, c.xy, centre.xy) && overlap2d(a.yz, b.yz, c.yz, centre.yz) && overlap2d(a.zx, b.zx, c.zx, centre.zx);
}

// Barycentric coordinates in the projection, clamped to the triangle.
vec3 barycentric(vec2 point) {
  vec2 e1 = corners[1].xy - corners[0].xy, e2 = corners[2].xy - corners[0].xy, p = point - corners[0].xy;
  float doubleArea = e1.x * e2.y - e1.y * e2.x;
  if (doubleArea == 0.0) return vec3(1.0 / 3.0);
  vec2 weights = vec2(p.x * e2.y - p.y * e2.x, e1.x * p.y - e1.y * p.x) / doubleArea;
  vec3 result = max(vec3(1.0 - weights.x - weights.y, weights), 0.0);
  return result / (result.x + result.y + result.z);
}

void main() {
  vec2 pixel = floor(plane);
  vec3 normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
  float lowest = min(corners[0].z, min(corners[1].z, corners[2].z)), highest = max(corners[0].z, max(corners[1].z, corners[2].z));
  vec3 weights = barycentric(pixel + 0.5);
  vec3 centre = corners * weights;

  float first = centre.z, last = centre.z;
  if (depthRange != 0) {
    vec3 e0 = corners[1] - corners[0], e1 = corners[2] - corners[0], e2 = corners[2] - corners[1];
    float longest = max(dot(e0, e0), max(dot(e1, e1), dot(e2, e2)));
    if (dot(normal, normal) <= kNeedle * kNeedle * longest * longest) {
      // The plane of a needle is rounding: every voxel of its extent in this column is tested.
      first = lowest;
      last = highest;
    } else {
      // Depth of the plane over the whole pixel. The slope along the dominant axis is at most 1 in each direction.
      vec2 slope = -normal.xy / normal.z;
      float depth = corners[0].z + dot(slope, pixel + 0.5 - corners[0].xy);
      float reach = 0.5 * (abs(slope.x) + abs(slope.y));
      first = clamp(depth - reach, lowest, highest);
      last = clamp(depth + reach, lowest, highest);
    }
  }

  MaterialData material = materials[materialIndex];
  vec3 albedo = material.diffuse.rgb;
  float coverage = 1.0;
#if TEXTURES || MASKS
  vec2 texcoord = cornerTexcoords[0] * weights.x + cornerTexcoords[1] * weights.y + cornerTexcoords[2] * weights.z;
  // A pixel is a voxel wide: the gradients of the affine map select the mip that averages over a voxel.
  vec2 e1 = corners[1].xy - corners[0].xy, e2 = corners[2].xy - corners[0].xy;
  vec2 t1 = cornerTexcoords[1] - cornerTexcoords[0], t2 = cornerTexcoords[2] - cornerTexcoords[0];
  float doubleArea = e1.x * e2.y - e1.y * e2.x;
  float inverse = doubleArea != 0.0 ? 1.0 / doubleArea : 0.0;
  vec2 gradientX = (t1 * e2.y - t2 * e1.y) * inverse, gradientY = (t2 * e1.x - t1 * e2.x) * inverse;
#endif
#if TEXTURES
  albedo *= textureGrad(diffuseTexture, texcoord, gradientX, gradientY).rgb;
#endif
#if MASKS
  coverage = textureGrad(maskTexture, texcoord, gradientX, gradientY).r;
#endif
  if (coverage <= 0.0) discard;
  vec3 normalWorld = cornerNormals * weights;

  int from = max(int(floor(first)), 0), to = int(floor(last));
  for (int depth = from; depth <= to; ++depth) {
    vec3 voxel = vec3(pixel, float(depth));
    if (!overlap(voxel, normal)) continue;
    ivec3 cell = ivec3(unpermute(voxel, dominantAxis));
    if (any(lessThan(cell, ivec3(0))) || any(greaterThanEqual(cell, resolution))) continue;
    uint index = atomicAdd(fragmentCount, 1u);
    if (index >= uint(capacity)) continue;
    VoxelFragment fragment;
    fragment.voxel = packVoxel(cell);
    fragment.offset = packOffset(unpermute(centre - voxel, dominantAxis));
    fragment.normal = packNormal(normalize(normalWorld));
    fragment.albedoRg = packHalf2x16(albedo.rg);
    fragment.albedoBCoverage = packHalf2x16(vec2(albedo.b, coverage));
    fragment.emission = packShared(material.emission.rgb);
    fragments[index] = fragment;
  }
}
