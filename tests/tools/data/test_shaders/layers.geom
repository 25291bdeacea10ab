layout(triangles) in;
layout(triangle_strip, max_vertices = 6) out;
layout(location = 0) flat out int layerIndex;
void main() {
  for (int layer = 0; layer < 2; ++layer) {
    for (int i = 0; i < 3; ++i) {
      gl_Position = gl_in[i].gl_Position;
      gl_Layer = layer;
      layerIndex = layer;
      EmitVertex();
    }
    EndPrimitive();
  }
}
