#version 450
// Sec. 3.2 step 4 as published: passes the averaged lights of vertices (interpolate_vertices.comp) to rasterisation.
#define SCENE_VERTICES
#include "common/scene.glsl"
#include "common/visible_surface.glsl"

struct VertexLight {
  vec4 light;
  vec4 offset;  // w 1: the vertex has light
};
layout(std140, binding = 4) uniform VertexSides {
  int sides;  // 1: only fronts have points
};
layout(std430, binding = 5) readonly buffer VertexLights { VertexLight vertexLights[]; };

layout(location = 0) out vec3 posWorld;
layout(location = 1) out vec3 normalWorld;
layout(location = 2) out vec4 frontLight;
layout(location = 3) out vec4 frontOffset;
layout(location = 4) out vec4 backLight;
layout(location = 5) out vec4 backOffset;
#if MASKS
layout(location = 6) out vec2 texcoord;
#endif

void main() {
  posWorld = vertexPosWorld();
  normalWorld = vertexNormalWorld();
  int first = gl_VertexID * sides;
  VertexLight front = vertexLights[first], back = VertexLight(vec4(0.0), vec4(0.0));
  if (sides > 1) back = vertexLights[first + 1];
  frontLight = front.light;
  frontOffset = front.offset;
  backLight = back.light;
  backOffset = back.offset;
#if MASKS
  texcoord = vertexTexcoord();
#endif
  placeVertex(posWorld);
}
