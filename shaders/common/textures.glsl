// Textures of the material, as the axes TEXTURES and MASKS say.
#ifndef LUMIVOX_TEXTURES
#define LUMIVOX_TEXTURES
#if TEXTURES
layout(binding = 0) uniform sampler2D diffuseTexture;
#endif
#if MASKS
layout(binding = 1) uniform sampler2D maskTexture;
#endif

#endif
