#version 450
// Every light at every pixel, without occlusion: the reference for the time and the error of sparse points (Sec. 6, Fig. 5).
#pragma lumivox axis LOBE diffuse glossy
#pragma lumivox axis LOBED 0 1  // lights may have lobes
layout(local_size_x = 8, local_size_y = 8) in;
#include "discs.glsl"
#if LOBED
#include "common/surface_lobe.glsl"
#endif

const int kChunk = 128;  // as in gather.comp: a separate sum per chunk keeps small addends

layout(std140, binding = 0) uniform Parameters {
  vec3 eyeWorld;
  int firstLight, lights;  // range of lights in the buffer that this dispatch adds
  int begins;              // 1: the first dispatch
};
layout(binding = 0) uniform sampler2D gPosition;
layout(binding = 1) uniform sampler2D gNormal;
#if LOBE == LOBE_DIFFUSE
layout(binding = 2) uniform sampler2D gDiffuse;
#else
layout(binding = 3) uniform sampler2D gSpecular;
#endif
layout(std430, binding = 0) readonly buffer SurfaceLights { SurfaceLight surfaceLights[]; };
layout(binding = 0, rgba32f) uniform image2D reflectedImage;

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, textureSize(gPosition, 0)))) return;
  vec4 position = texelFetch(gPosition, pixel, 0);
  vec3 normal = texelFetch(gNormal, pixel, 0).xyz;
#if LOBE == LOBE_DIFFUSE
  vec4 material = texelFetch(gDiffuse, pixel, 0);
#else
  vec4 material = texelFetch(gSpecular, pixel, 0);
  vec3 toEye = eyeWorld - position.xyz;
  toEye = dot(toEye, toEye) > 0.0 ? normalize(toEye) : normal;
#endif
  vec3 reflected = begins != 0 ? vec3(0.0) : imageLoad(reflectedImage, pixel).rgb;
  if (position.w > 0.0 && any(greaterThan(material.rgb, vec3(0.0)))) {
    for (int first = firstLight; first < firstLight + lights; first += kChunk) {
      vec3 sum = vec3(0.0);
      for (int i = first; i < min(first + kChunk, firstLight + lights); ++i) {
        SurfaceLight light = surfaceLights[i];
#if LOBED
        light.flux.rgb = fluxTowards(light, position.xyz);
#endif
#if LOBE == LOBE_DIFFUSE
        sum += surfaceLightIrradiance(light, position.xyz, normal);
#else
        vec3 path = light.positionArea.xyz - position.xyz;
        float distanceSquared = dot(path, path);
        if (distanceSquared == 0.0 || light.positionArea.w <= 0.0) continue;
        vec3 toLight = path * inversesqrt(distanceSquared);
        float width = discWidth(light.positionArea.w, -dot(toLight, light.normal.xyz), distanceSquared);
        sum += light.flux.rgb * (lobeReflected(material.w, width, normal, toEye, toLight) / light.positionArea.w);
#endif
      }
      reflected += material.rgb / kPi * sum;
    }
  }
  imageStore(reflectedImage, pixel, vec4(reflected, 1.0));
}
