#version 450
// Dachsbacher & Stamminger 2005, Sec. 4.1: position, normal and reflected flux of the surface in each texel of a light's view.
#pragma lumivox axis TEXTURES 0 1
#pragma lumivox axis MASKS 0 1
#pragma lumivox axis SURFACES 0 1  // what the surfaces reflect is kept beside their flux
#pragma lumivox axis GLOSSY 0 1    // their Phong lobe too
#pragma lumivox axis LOBES 0 1     // the flux holds what Phong lobes reflect, too
#pragma lumivox require SURFACES || LOBES || !GLOSSY
#define SCENE_MATERIALS
#include "common/lights.glsl"
#if LOBES
#include "common/brdf.glsl"
#endif
#include "common/scene.glsl"
#include "cross_section.glsl"

layout(std140, binding = 1) uniform View {
  mat4 worldToClip;
  int lightIndex;
  float halfSize;  // texels
};

#if TEXTURES
layout(binding = 0) uniform sampler2D diffuseTexture;
#endif
#if MASKS
layout(binding = 1) uniform sampler2D maskTexture;
#endif

layout(location = 0) in vec3 posWorld;
layout(location = 1) in vec3 normalWorld;
#if TEXTURES || MASKS
layout(location = 2) in vec2 texcoord;
#endif

layout(location = 0) out vec4 outPosition;
layout(location = 1) out vec4 outNormal;
layout(location = 2) out vec4 outFlux;
#if SURFACES
layout(location = 3) out vec4 outAlbedo;
#endif
#if GLOSSY
layout(location = 3 + SURFACES) out vec4 outSpecular;
#endif
#if SURFACES && LOBES
layout(location = 4 + GLOSSY) out vec4 outDiffuseFlux;  // for paths, which reflect by the lobes themselves
#endif

// At more grazing angles the patch of a texel does not grow further: one texel cannot represent a longer patch.
const float kSmallestCosine = 0.02;

void main() {
  // Derivatives, and texture samples that select their mip level by derivatives, come before any discard: after it they are undefined.
  vec3 geometricNormal = cross(dFdx(posWorld), dFdy(posWorld));
  vec3 albedo = materials[materialIndex].diffuse.rgb;
#if TEXTURES
  albedo *= texture(diffuseTexture, texcoord).rgb;
#endif
#if MASKS
  if (texture(maskTexture, texcoord).r < kMaskThreshold) discard;
#endif
  LightSample light = lights[lightIndex];
  vec3 toLight;
  vec3 perpendicular = arrivingIrradiance(light, posWorld, toLight);
  float size = length(geometricNormal);
  geometricNormal = size > 0.0 ? geometricNormal / size : normalize(normalWorld);
  if (dot(geometricNormal, toLight) < 0.0) geometricNormal = -geometricNormal;
  vec3 normal = normalize(normalWorld);
  if (dot(normal, geometricNormal) < 0.0) normal = -normal;

  float crossSection = crossSectionOf(light, posWorld, gl_FragCoord.xy - halfSize);
  outPosition = vec4(posWorld, 1.0);
  outNormal = vec4(normal, crossSection / max(dot(geometricNormal, toLight), kSmallestCosine));
  // The flux through the cross-section, independent of the slant: exact even if the patch is seen edge-on.
  vec3 reflected = albedo;
#if LOBES
  // Deviates: the paper's surfaces are diffuse. The texel's light is right in sum; readers of the lobe set its direction right.
  vec4 specular = materials[materialIndex].specular;
  reflected += specular.rgb * phongAlbedo(specular.w, max(dot(normal, toLight), 0.0));
#endif
  outFlux = vec4(reflected * perpendicular * crossSection, float(lightIndex));
#if SURFACES
  outAlbedo = vec4(albedo, 1.0);
#if LOBES
  outDiffuseFlux = vec4(albedo * perpendicular * crossSection, float(lightIndex));
#endif
#endif
#if GLOSSY
  outSpecular = materials[materialIndex].specular;
#endif
}
