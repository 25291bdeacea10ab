#version 450
// Crassin & Green 2012, Sec. 22.3; thesis 004 Sec. 2.1.2: each triangle is projected along the dominant axis of its normal and enlarged,
// so that it covers the centre of every pixel that it touches. Deviates: no geometry shader. The vertex shader reads all three corners of
// its triangle, which is faster and gives the same enlarged triangle.
#define SCENE_VERTICES
#include "common/scene.glsl"
#include "common/voxel.glsl"
#include "list_grid.glsl"
layout(std430, binding = 6) readonly buffer Indices { uint indices[]; };

layout(std140, binding = 1) uniform Part { int firstIndex; };
#include "common/corners.glsl"

// The triangle: corners in voxels, permuted so that z is the dominant axis; normals in world space, not permuted; texture coordinates.
layout(location = 0) flat out mat3 corners;
layout(location = 3) flat out mat3 cornerNormals;
layout(location = 6) flat out int dominantAxis;
#if TEXTURES || MASKS
layout(location = 7) flat out vec2 cornerTexcoords[3];
#endif

// In pixels. The fragment shader tests each voxel exactly, so rasterisation must only miss none. It snaps corners to 1/256 pixel or finer.
const float kEnlarged = 0.5 + 1.0 / 64.0;

// Corner `k` of the triangle enlarged by half a pixel (Hasselgren et al. 2005, Sec. 42.2): the crossing of its two shifted edges.
vec2 enlargedCorner(vec2 a, vec2 b, vec2 c, int k) {
  vec2 e0 = b - a, e1 = c - b, e2 = a - c;
  float doubleArea = e0.x * e1.y - e0.y * e1.x;
  float longest = max(dot(e0, e0), max(dot(e1, e1), dot(e2, e2)));
  // The enlarged corners of a needle would lie far away. A right triangle with twice the sides of its bounding box covers it as well.
  if (!(abs(doubleArea) > kNeedle * longest)) {
    vec2 low = min(a, min(b, c)) - kEnlarged, high = max(a, max(b, c)) + kEnlarged;
    vec2 size = 2.0 * (high - low);
    return low + (k == 0 ? vec2(0.0) : k == 1 ? vec2(size.x, 0.0) : vec2(0.0, size.y));
  }
  vec2 corner = k == 0 ? a : k == 1 ? b : c;
  vec2 before = k == 0 ? e2 : k == 1 ? e0 : e1;
  vec2 after = k == 0 ? e0 : k == 1 ? e1 : e2;
  float turn = doubleArea > 0.0 ? 1.0 : -1.0;
  // Outward normals of the two edges. Each edge moves along its normal by the half extent of a pixel in this direction.
  vec2 n0 = turn * vec2(before.y, -before.x), n1 = turn * vec2(after.y, -after.x);
  float d0 = kEnlarged * (abs(n0.x) + abs(n0.y)), d1 = kEnlarged * (abs(n1.x) + abs(n1.y));
  // Solve n0 . x = d0, n1 . x = d1 relative to the corner.
  float determinant = n0.x * n1.y - n0.y * n1.x;
  return corner + vec2(d0 * n1.y - d1 * n0.y, n0.x * d1 - n1.x * d0) / determinant;
}

void main() {
  int triangle = gl_VertexID / 3;
  TriangleCorners loaded = loadCorners(uint(firstIndex) + 3u * uint(triangle), objectIndex);
  corners = loaded.corners;
  cornerNormals = loaded.normals;
  dominantAxis = loaded.axis;
#if TEXTURES || MASKS
  cornerTexcoords = loaded.texcoords;
#endif
  vec2 plane = enlargedCorner(corners[0].xy, corners[1].xy, corners[2].xy, gl_VertexID - 3 * triangle);
  // Row 0 is the top of a render target: y is flipped, so that pixel (x, y) is column (x, y).
  float side = float(max(resolution.x, max(resolution.y, resolution.z)));
  gl_Position = vec4(2.0 * plane.x / side - 1.0, 1.0 - 2.0 * plane.y / side, 0.5, 1.0);
}
