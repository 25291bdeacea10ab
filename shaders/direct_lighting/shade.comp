#version 450
// Direct light at the visible surfaces: emission, and every light sample times its visibility through both lobes.
#pragma lumivox axis LIGHTS 0 1
#pragma lumivox axis SHADOWS 0 1
#pragma lumivox axis GLOSSY 0 1
#pragma lumivox axis EMISSION 0 1
#pragma lumivox axis MEDIUM none even varying
#pragma lumivox require !SHADOWS || LIGHTS
#pragma lumivox require MEDIUM == none || LIGHTS
#include "common/brdf.glsl"
#if SHADOWS
#define SHADOW_VIEWS
#endif
#if LIGHTS
#include "common/lights.glsl"
#endif
#if MEDIUM != MEDIUM_NONE
#include "common/media.glsl"
#endif

layout(local_size_x = 8, local_size_y = 8) in;

layout(std140, binding = 0) uniform Parameters {
  vec3 eyeWorld;
  int lightCount;
  vec3 environment;  // radiance that a camera ray sees when it hits nothing
  int mediumSteps;   // most steps through a medium that varies, towards a light
};

layout(binding = 0) uniform sampler2D gPosition;
layout(binding = 1) uniform sampler2D gNormal;
layout(binding = 2) uniform sampler2D gGeometricNormal;
layout(binding = 3) uniform sampler2D gDiffuse;
#if GLOSSY
layout(binding = 4) uniform sampler2D gSpecular;
#endif
#if EMISSION
layout(binding = 5) uniform sampler2D gEmission;
#endif
layout(binding = 0, rgba32f) uniform writeonly image2D radianceImage;

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(radianceImage)))) return;
  vec4 position = texelFetch(gPosition, pixel, 0);
  if (position.w == 0.0) {
    imageStore(radianceImage, pixel, vec4(environment, 1.0));
    return;
  }
  vec3 radiance = vec3(0.0);
#if EMISSION
  radiance += texelFetch(gEmission, pixel, 0).rgb;
#endif
#if LIGHTS
  vec3 normal = texelFetch(gNormal, pixel, 0).xyz;
  vec3 geometricNormal = texelFetch(gGeometricNormal, pixel, 0).xyz;
  vec3 diffuse = texelFetch(gDiffuse, pixel, 0).rgb;
  vec3 toEye = normalize(eyeWorld - position.xyz);
  vec3 reflected = vec3(0.0);
  for (int i = 0; i < lightCount; ++i) {
    LightSample light = lights[i];
    vec3 toLight;
    vec3 perpendicular = arrivingIrradiance(light, position.xyz, toLight);
    float cosSurface = dot(normal, toLight);
    // Light from below either plane does not reach the side that is seen.
    if (cosSurface <= 0.0 || dot(geometricNormal, toLight) <= 0.0) continue;
    vec3 irradiance = perpendicular * cosSurface;
#if SHADOWS
    irradiance *= visibility(light, position.xyz, geometricNormal, toLight);
#endif
#if MEDIUM != MEDIUM_NONE
    if (any(greaterThan(irradiance, vec3(0.0)))) irradiance *= transmittanceToLight(light, position.xyz, mediumSteps);
#endif
    vec3 lobes = diffuse / kPi;
#if GLOSSY
    vec4 specular = texelFetch(gSpecular, pixel, 0);
    lobes += phongLobe(specular.rgb, specular.w, normal, toEye, toLight);
#endif
    reflected += irradiance * lobes;
  }
  radiance += reflected;
#endif
  imageStore(radianceImage, pixel, vec4(radiance, 1.0));
}
