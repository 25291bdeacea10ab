#version 450
// The visible surfaces: geometry stage.
#define SCENE_VERTICES
#include "common/scene.glsl"

layout(std140, binding = 1) uniform View { mat4 worldToClip; };

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
  gl_Position = worldToClip * vec4(posWorld, 1.0);
}
