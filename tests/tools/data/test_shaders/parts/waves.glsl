// Shared by values.comp and triangle.frag.
layout(std140, binding = 1) uniform Waves {
  vec3 direction;
  float frequency;
  ivec2 offset;
  uint seed;
  bool inverted;
  mat4 toGrid;
  vec4 weights[3];
};

float wave(float x) {
  float value = sin(x * frequency) * weights[1].z + dot(direction, vec3(x, x * x, sqrt(abs(x))));
  return inverted ? -value : value;
}
