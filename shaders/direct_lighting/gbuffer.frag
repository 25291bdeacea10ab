#version 450
// The visible surfaces: the attributes of the nearest surface, in linear units.
#pragma lumivox axis TEXTURES 0 1
#pragma lumivox axis MASKS 0 1
#pragma lumivox axis GLOSSY 0 1
#pragma lumivox axis EMISSION 0 1
#define SCENE_MATERIALS
#include "common/scene.glsl"
#include "common/visible_surface.glsl"

#if TEXTURES
layout(binding = 0) uniform sampler2D diffuseTexture;
#endif

layout(location = 0) in vec3 posWorld;
layout(location = 1) in vec3 normalWorld;
#if TEXTURES || MASKS
layout(location = 2) in vec2 texcoord;
#endif

layout(location = 0) out vec4 outPosition;
layout(location = 1) out vec4 outNormal;
layout(location = 2) out vec4 outGeometricNormal;
layout(location = 3) out vec4 outDiffuse;
#if GLOSSY
layout(location = 4) out vec4 outSpecular;
#endif
#if EMISSION
layout(location = 5) out vec4 outEmission;
#endif

void main() {
  // Derivatives, and texture samples that select their mip level by derivatives, come before any discard: after it they are undefined.
  vec3 geometricNormal = cross(dFdx(posWorld), dFdy(posWorld));
  MaterialData material = materials[materialIndex];
  vec3 albedo = material.diffuse.rgb;
#if TEXTURES
  albedo *= texture(diffuseTexture, texcoord).rgb;
#endif
#if MASKS
  bool hidden = isHole(texcoord);
#else
  bool hidden = false;
#endif
  if (hidden || isElsewhere(posWorld)) discard;
  vec3 toEye = eyeWorld - posWorld;
  float size = length(geometricNormal);
  geometricNormal = size > 0.0 ? geometricNormal / size : normalize(normalWorld);
  if (dot(geometricNormal, toEye) < 0.0) geometricNormal = -geometricNormal;
  // Surfaces are two-sided: the shading normal is turned to the visible side of the geometric normal.
  vec3 normal = normalize(normalWorld);
  if (dot(normal, geometricNormal) < 0.0) normal = -normal;

  outPosition = vec4(posWorld, 1.0);
  outNormal = vec4(normal, gl_FrontFacing ? 1.0 : 0.0);
  outGeometricNormal = vec4(geometricNormal, model);
  outDiffuse = vec4(albedo, 1.0);
#if GLOSSY
  outSpecular = material.specular;
#endif
#if EMISSION
  outEmission = vec4(gl_FrontFacing ? material.emission.rgb : vec3(0.0), 1.0);
#endif
}
