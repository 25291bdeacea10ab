#version 450
// Depth as seen from a light: only holes of alpha masks need a fragment stage.
#pragma lumivox axis MASKS 0 1
#include "common/scene.glsl"

#if MASKS
layout(binding = 1) uniform sampler2D maskTexture;
layout(location = 0) in vec2 texcoord;
#endif

void main() {
#if MASKS
  if (texture(maskTexture, texcoord).r < kMaskThreshold) discard;
#endif
}
