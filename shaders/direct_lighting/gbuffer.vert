#version 450
// The visible surfaces: geometry stage.
#define SCENE_VERTICES
#include "common/scene.glsl"
#include "common/visible_surface.glsl"

layout(location = 0) out vec3 posWorld;
layout(location = 1) out vec3 normalWorld;
#if TEXTURES || MASKS
layout(location = 2) out vec2 texcoord;
#endif

void main() {
  posWorld = vertexPosWorld();
  normalWorld = vertexNormalWorld();
#if TEXTURES || MASKS
  texcoord = vertexTexcoord();
#endif
  placeVertex(posWorld);
}
