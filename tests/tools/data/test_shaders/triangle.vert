#include "parts/waves.glsl"
layout(std430, binding = 0) readonly buffer Corners { vec2 corners[]; };
layout(location = 0) out vec2 position;
void main() {
  position = corners[gl_VertexID];
  gl_Position = vec4(position, 0.5, 1.0);
}
