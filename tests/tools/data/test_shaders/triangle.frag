#pragma lumivox axis SHADOWED 0 1
#include "parts/waves.glsl"
layout(location = 0) in vec2 position;
layout(location = 0) out vec4 radiance;
#if SHADOWED
layout(binding = 0) uniform sampler2DArrayShadow shadowMap;
#endif
void main() {
  radiance = vec4(wave(position.x), wave(position.y), gl_FragCoord.xy);
#if SHADOWED
  radiance *= texture(shadowMap, vec4(0.5, 0.5, 0.0, gl_FragCoord.z));
#endif
}
