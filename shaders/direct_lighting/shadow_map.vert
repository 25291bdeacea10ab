#version 450
// Depth as seen from a light (Williams 1978, "Casting curved shadows on curved surfaces").
#define SCENE_VERTICES
#include "common/scene.glsl"

layout(std140, binding = 1) uniform View { mat4 worldToClip; };

#if MASKS
layout(location = 0) out vec2 texcoord;
#endif

void main() {
#if MASKS
  texcoord = vertexTexcoord();
#endif
  gl_Position = worldToClip * vec4(vertexPosWorld(), 1.0);
}
