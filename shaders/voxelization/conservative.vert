#version 450
// Crassin & Green 2012, Sec. 22.3; thesis 004 Sec. 2.1.2: each triangle is projected along the dominant axis of its normal and enlarged,
// so that it covers the centre of every pixel that it touches. Deviates: no geometry stage; the vertex stage reads all three corners
// of its triangle, since drivers run that faster than amplification, and the result is the same triangle.
#define SCENE_VERTICES
#include "common/scene.glsl"
#include "common/voxel.glsl"

layout(std430, binding = 6) readonly buffer Indices { uint indices[]; };

layout(std140, binding = 1) uniform Grid {
  vec3 gridLow;     // m
  float voxelSize;  // m
  ivec3 resolution;
  int firstIndex;   // of this draw
  int capacity;     // fragments that fit into the list
  int depthRange;   // 1: every voxel that the triangle crosses in depth; 0: only the one at the pixel's centre
};

// Corners, normals and texture coordinates of the triangle, permuted so that z is the dominant axis; in voxels.
layout(location = 0) noperspective out vec2 plane;
layout(location = 1) flat out mat3 corners;
layout(location = 4) flat out mat3 cornerNormals;
layout(location = 7) flat out int dominantAxis;
#if TEXTURES || MASKS
layout(location = 8) flat out vec2 cornerTexcoords[3];
#endif

vec3 permute(vec3 v, int axis) { return axis == 0 ? v.yzx : axis == 1 ? v.zxy : v; }

// Corner `k` of the triangle enlarged by half a pixel (Hasselgren et al. 2005, Sec. 42.2): the crossing of its two shifted edges.
vec2 enlargedCorner(vec2 a, vec2 b, vec2 c, int k) {
  vec2 e0 = b - a, e1 = c - b, e2 = a - c;
  float doubleArea = e0.x * e1.y - e0.y * e1.x;
  float longest = max(dot(e0, e0), max(dot(e1, e1), dot(e2, e2)));
  // A needle would throw its corners far away: twice its bounding box, as a triangle, covers it just as well.
  if (abs(doubleArea) <= kNeedle * longest) {
    vec2 low = min(a, min(b, c)) - 0.5, high = max(a, max(b, c)) + 0.5;
    vec2 size = 2.0 * (high - low);
    return low + (k == 0 ? vec2(0.0) : k == 1 ? vec2(size.x, 0.0) : vec2(0.0, size.y));
  }
  vec2 corner = k == 0 ? a : k == 1 ? b : c;
  vec2 before = k == 0 ? e2 : k == 1 ? e0 : e1;
  vec2 after = k == 0 ? e0 : k == 1 ? e1 : e2;
  float turn = doubleArea > 0.0 ? 1.0 : -1.0;
  // Outward normals of the two edges; each edge moves by the half extent of a pixel along its normal.
  vec2 n0 = turn * vec2(before.y, -before.x), n1 = turn * vec2(after.y, -after.x);
  float d0 = 0.5 * (abs(n0.x) + abs(n0.y)), d1 = 0.5 * (abs(n1.x) + abs(n1.y));
  // Solve n0 . x = d0, n1 . x = d1 relative to the corner.
  float determinant = n0.x * n1.y - n0.y * n1.x;
  return corner + vec2(d0 * n1.y - d1 * n0.y, n0.x * d1 - n1.x * d0) / determinant;
}

void main() {
  int triangle = gl_VertexID / 3;
  int k = gl_VertexID - 3 * triangle;
  vec3 corner[3];
  for (int i = 0; i < 3; ++i) {
    int vertex = int(indices[firstIndex + 3 * triangle + i]);
    vec3 local = vec3(positions[3 * vertex], positions[3 * vertex + 1], positions[3 * vertex + 2]);
    corner[i] = ((objects[objectIndex].toWorld * vec4(local, 1.0)).xyz - gridLow) / voxelSize;
    vec3 normal = vec3(normals[3 * vertex], normals[3 * vertex + 1], normals[3 * vertex + 2]);
    cornerNormals[i] = mat3(objects[objectIndex].normalToWorld) * normal;
#if TEXTURES || MASKS
    cornerTexcoords[i] = vec2(texcoords[2 * vertex], 1.0 - texcoords[2 * vertex + 1]);
#endif
  }
  vec3 normal = abs(cross(corner[1] - corner[0], corner[2] - corner[0]));
  dominantAxis = normal.x > normal.y && normal.x > normal.z ? 0 : normal.y > normal.z ? 1 : 2;
  for (int i = 0; i < 3; ++i) corners[i] = permute(corner[i], dominantAxis);
  plane = enlargedCorner(corners[0].xy, corners[1].xy, corners[2].xy, k);
  float side = float(max(resolution.x, max(resolution.y, resolution.z)));
  gl_Position = vec4(2.0 * plane / side - 1.0, 0.5, 1.0);
}
