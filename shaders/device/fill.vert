#version 450
// Many small triangles, one per pixel, or one triangle that covers the whole target.
#pragma lumivox axis SHAPE whole small

layout(std140, binding = 0) uniform Parameters {
  int side;           // of the target, pixels
};

void main() {
#if SHAPE == SHAPE_WHOLE
  gl_Position = vec4(gl_VertexID % 3 == 1 ? 3.0 : -1.0, gl_VertexID % 3 == 2 ? 3.0 : -1.0, 0.5, 1.0);
#else
  // Triangle i lies in pixel i and covers its centre.
  int triangle = gl_VertexID / 3, corner = gl_VertexID % 3;
  vec2 pixel = vec2(triangle % side, triangle / side % side);
  vec2 inside = vec2(corner == 1 ? 0.9 : 0.2, corner == 2 ? 0.9 : 0.2);
  inside = corner == 0 ? vec2(0.2, 0.2) : inside;
  gl_Position = vec4((pixel + inside) * (2.0 / float(side)) - 1.0, 0.5, 1.0);
#endif
}
