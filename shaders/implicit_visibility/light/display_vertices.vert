#version 450
// Dong et al. 2007, Sec. 4.3.1: values of elements at the vertices on which they are placed.
#define SCENE_VERTICES
#include "common/scene.glsl"
#include "common/visible_surface.glsl"
#include "texels.glsl"

layout(std430, binding = 5) readonly buffer VertexLeaves { uint vertexLeaves[]; };  // leaf of each vertex; all bits set: none
layout(binding = 4) uniform sampler2D leafValues;                                   // two texels per leaf: front, back

layout(location = 0) out vec3 posWorld;
layout(location = 1) out vec3 normalWorld;
layout(location = 2) out vec3 front;
layout(location = 3) out vec3 back;
layout(location = 4) out float known;  // 0 if the vertex has no element
#if MASKS
layout(location = 5) out vec2 texcoord;
#endif

void main() {
  posWorld = vertexPosWorld();
  normalWorld = vertexNormalWorld();
  uint leaf = vertexLeaves[gl_VertexID];
  bool any = leaf != 0xffffffffu;
  front = any ? texelFetch(leafValues, texelOf(2u * leaf), 0).rgb : vec3(0.0);
  back = any ? texelFetch(leafValues, texelOf(2u * leaf + 1u), 0).rgb : vec3(0.0);
  known = any ? 1.0 : 0.0;
#if MASKS
  texcoord = vertexTexcoord();
#endif
  placeVertex(posWorld);
}
