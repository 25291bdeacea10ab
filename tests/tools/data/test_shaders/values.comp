// Arithmetic whose bits must not depend on the way the shader reaches the driver, and every type of specialisation constant.
#pragma lumivox axis DOUBLED 0 1
#pragma lumivox axis SHAPE linear square cubic
#pragma lumivox require !DOUBLED || SHAPE == square
#include "parts/waves.glsl"

layout(local_size_x = 32) in;
layout(constant_id = 0) const int count = -3;
layout(constant_id = 1) const uint step = 7u;
layout(constant_id = 2) const float scale = 0.1;
layout(constant_id = 3) const bool shifted = false;

layout(std430, binding = 2) buffer Results {
  vec4 constants;
  vec4 values[];
};

void main() {
  uint i = gl_GlobalInvocationID.x;
  float x = float(i) * 0.37 + 0.01;
#if SHAPE == SHAPE_LINEAR
  float shaped = x;
#elif SHAPE == SHAPE_SQUARE
  float shaped = x * x;
#else
  float shaped = x * x * x;
#endif
#if DOUBLED
  shaped *= 2.0;
#endif
  vec4 transformed = toGrid * vec4(shaped, x, 1.0, 1.0);
  values[i] = vec4(wave(x), shaped, dot(transformed, weights[0]), exp(-x) + asin(fract(x)) + normalize(vec3(x, shaped, 1.0)).y + float(offset.y) + float(seed));
  if (i == 0u) constants = vec4(float(count), float(step), scale, shifted ? 1.0 : 0.0);
}
