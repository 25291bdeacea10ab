#version 450
// 3D clipmaps (thesis 004 Sec. 3.5.2): each triangle is projected along the dominant axis of its normal, without enlargement, because its
// covered samples are counted.
#define SCENE_VERTICES
#include "common/scene.glsl"
#include "common/voxel.glsl"

layout(std430, binding = 6) readonly buffer Indices { uint indices[]; };
#include "sample_grid.glsl"
#include "common/corners.glsl"
#include "common/covered_samples.glsl"

layout(location = 0) flat out mat3 corners;
layout(location = 3) flat out mat3 cornerNormals;
layout(location = 6) flat out int dominantAxis;
#if TEXTURES || MASKS
layout(location = 7) flat out vec2 cornerTexcoords[3];
#endif

void main() {
  int triangle = gl_VertexID / 3;
  TriangleCorners loaded = loadCorners(uint(firstIndex) + 3u * uint(triangle), objectIndex);
  corners = loaded.corners;
  cornerNormals = loaded.normals;
  dominantAxis = loaded.axis;
#if TEXTURES || MASKS
  cornerTexcoords = loaded.texcoords;
#endif
  vec2 plane = corners[gl_VertexID - 3 * triangle].xy;
  float side = float(max(resolution.x, max(resolution.y, resolution.z)));
  gl_Position = vec4(2.0 * plane.x / side - 1.0, 1.0 - 2.0 * plane.y / side, 0.5, 1.0);
  if (scaleOf(corners) != scale) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);  // drawn in the viewport of another scale: culled here
}
