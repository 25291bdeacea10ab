// Textures of the material, declared according to the axes TEXTURES and MASKS.
#ifndef LUMIVOX_TEXTURES
#define LUMIVOX_TEXTURES
#if TEXTURES
layout(binding = 0) uniform sampler2D diffuseTexture;
#endif
#if MASKS
layout(binding = 1) uniform sampler2D maskTexture;
#endif

#endif
