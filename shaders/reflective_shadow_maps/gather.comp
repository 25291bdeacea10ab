#version 450
// Dachsbacher & Stamminger 2005, Sec. 3.2 and 4.2: one-bounce light at the visible surfaces as the sum over texels of the reflective
// shadow map, without occlusion between texel and surface.
#pragma lumivox axis METHOD lights all projected
#pragma lumivox axis GLOSSY 0 1  // lights may have lobes
#pragma lumivox require METHOD == lights || !GLOSSY
#include "common/rsm.glsl"
#if GLOSSY
#include "common/surface_lobe.glsl"
#endif
#if METHOD == METHOD_PROJECTED
#include "common/lights.glsl"
#endif

layout(local_size_x = 8, local_size_y = 8) in;

layout(std140, binding = 0) uniform Parameters {
  int width;      // texels along a side of a layer
  int first;      // first light, or first row of texels of all layers, of this dispatch; count: their number
  int count;
  int samples;    // METHOD_PROJECTED: texels per light
  int lightCount;
  float reach;    // METHOD_PROJECTED: radius of the pattern, as a share of a half turn or of the width of the view
  float publishedScale;  // one over the sum of the printed weights; 0: weights by the density of the pattern
};
layout(binding = 0) uniform sampler2D gPosition;
layout(binding = 1) uniform sampler2D gNormal;
layout(binding = 2) uniform sampler2D gDiffuse;
#if METHOD != METHOD_LIGHTS
layout(binding = 3) uniform sampler2DArray rsmPosition;
layout(binding = 4) uniform sampler2DArray rsmNormal;
layout(binding = 5) uniform sampler2DArray rsmFlux;
#else
layout(std430, binding = 1) readonly buffer Taken { SurfaceLight taken[]; };
#endif
#if METHOD == METHOD_PROJECTED
layout(std430, binding = 6) readonly buffer Views { mat4 views[]; };
#endif
layout(binding = 0, rgba32f) uniform image2D diffuseImage;

#if METHOD != METHOD_LIGHTS
SurfaceLight lightAt(ivec3 texel) {
  vec4 normalArea = texelFetch(rsmNormal, texel, 0);
  return SurfaceLight(vec4(texelFetch(rsmPosition, texel, 0).xyz, normalArea.w), vec4(normalArea.xyz, 0.0),
                      vec4(texelFetch(rsmFlux, texel, 0).rgb, 0.0));
}
#endif

#if METHOD == METHOD_PROJECTED
// Sec. 4.2: samples around the projection of the surface point into the light's view, denser near it: at the distance reach * xi1 and the
// angle 2 pi xi2. For a directional light, the pattern lies in the plane of its view. Deviates: for lights with perspective it lies on the
// sphere around the light, across the faces of a cube; and the weight is the Jacobian of the pattern, which makes the sum exact for a
// constant map. The published weight is xi1^2 over the sum of all xi1^2, so that the samples together represent the area of the pattern:
// with a single view, the disc in its plane, in any perspective; with a cube, which the paper does not mention, a cap of the sphere.
vec3 aroundProjection(LightSample light, vec3 posWorld, vec3 normal) {
  bool directional = light.kind == kLightDirectional, published = publishedScale > 0.0;
  bool inView = !directional && published && light.viewCount == 1;
  int firstLayer = light.firstView;
  vec2 centre = vec2(0.0);
  if (inView) {
    vec4 clip = views[firstLayer] * vec4(posWorld, 1.0);
    if (clip.w <= 0.0) return vec3(0.0);  // no projection behind the light
    centre = vec2(0.5 + 0.5 * clip.x / clip.w, 0.5 - 0.5 * clip.y / clip.w);
  }
  vec3 axis = directional ? light.direction : normalize(posWorld - light.position);
  vec3 helper = abs(axis.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0);
  vec3 tangent = normalize(cross(helper, axis)), bitangent = cross(axis, tangent);
  float largest = directional ? reach * light.texelWidth * float(width) : reach * kPi;
  // Area of the disc, m^2, or texels if it lies in the view; solid angle of the cap, sr.
  float covered = directional ? kPi * largest * largest : 2.0 * kPi * (1.0 - cos(largest));
  if (inView) covered = kPi * reach * reach * float(width) * float(width);
  vec3 sum = vec3(0.0);
  for (int i = 0; i < samples; ++i) {
    // R2 sequence (Roberts 2018), the same for every pixel, as published.
    float xi1 = fract(0.5 + 0.7548776662466927 * float(i + 1)), xi2 = fract(0.5 + 0.5698402909980532 * float(i + 1));
    float angle = 2.0 * kPi * xi2, distance = largest * xi1;
    int layer = firstLayer;
    vec2 texcoord = centre + reach * xi1 * vec2(cos(angle), sin(angle));
    if (!inView) {
      vec3 side = tangent * cos(angle) + bitangent * sin(angle);
      vec3 target = directional ? posWorld + side * distance : light.position + axis * cos(distance) + side * sin(distance);
      if (light.viewCount > 1) layer += cubeFace(target - light.position);
      vec4 clip = views[layer] * vec4(target, 1.0);
      if (clip.w <= 0.0) continue;
      vec2 projected = clip.xy / clip.w;
      texcoord = vec2(0.5 + 0.5 * projected.x, 0.5 - 0.5 * projected.y);
    }
    if (any(lessThan(texcoord, vec2(0.0))) || any(greaterThanEqual(texcoord, vec2(1.0)))) continue;
    SurfaceLight patchLight = lightAt(ivec3(ivec2(texcoord * float(width)), layer));
    // Number of texels that one sample represents: its area on the plane or the sphere over that of a texel.
    float texelSize = light.texelWidth * light.texelWidth;
    if (!directional) {
      vec2 onPlane = (texcoord - 0.5) * float(width) * light.texelWidth;
      float secantSquared = 1.0 + dot(onPlane, onPlane);
      texelSize /= secantSquared * sqrt(secantSquared);
    }
    if (inView) texelSize = 1.0;
    float ring = directional ? distance : sin(distance);
    float part = published ? covered * xi1 * xi1 * publishedScale : 2.0 * kPi * largest * ring / float(samples);
    float copies = part / texelSize;
    patchLight.flux.rgb *= copies;
    patchLight.positionArea.w *= copies;
    sum += surfaceLightIrradiance(patchLight, posWorld, normal);
  }
  return sum;
}
#endif

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, textureSize(gPosition, 0)))) return;
  vec4 position = texelFetch(gPosition, pixel, 0);
  vec3 albedo = texelFetch(gDiffuse, pixel, 0).rgb;
  vec3 irradiance = vec3(0.0);
  if (position.w > 0.0 && any(greaterThan(albedo, vec3(0.0)))) {
    vec3 normal = texelFetch(gNormal, pixel, 0).xyz;
#if METHOD == METHOD_LIGHTS
    for (int i = first; i < first + count; ++i) {
      SurfaceLight light = taken[i];
#if GLOSSY
      light.flux.rgb = fluxTowards(light, position.xyz);
#endif
      irradiance += surfaceLightIrradiance(light, position.xyz, normal);
    }
#elif METHOD == METHOD_ALL
    for (int row = first; row < first + count; ++row) {
      // A sum per row limits the rounding error of a million small addends.
      vec3 sum = vec3(0.0);
      for (int x = 0; x < width; ++x) {
        ivec3 texel = ivec3(x, row % width, row / width);
        if (all(equal(texelFetch(rsmFlux, texel, 0).rgb, vec3(0.0)))) continue;
        sum += surfaceLightIrradiance(lightAt(texel), position.xyz, normal);
      }
      irradiance += sum;
    }
#else
    for (int i = 0; i < lightCount; ++i) irradiance += aroundProjection(lights[i], position.xyz, normal);
#endif
  }
  vec3 radiance = albedo / kPi * irradiance;
#if METHOD != METHOD_PROJECTED
  if (first > 0) radiance += imageLoad(diffuseImage, pixel).rgb;
#endif
  imageStore(diffuseImage, pixel, vec4(radiance, 1.0));
}
