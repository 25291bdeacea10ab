#version 450
// Sec. 3.2 steps 3 and 4: reflects the averaged light of the points nearest to a pixel, or (AT vertices) the light interpolated by
// rasterisation, by the pixel's own normal and material (Eq. 10).
#pragma lumivox axis DIFFUSE 0 1
#pragma lumivox axis GLOSSY 0 1
#pragma lumivox axis INTERPOLATE averaged plain
#pragma lumivox axis AT pixels vertices
#pragma lumivox require DIFFUSE || GLOSSY
layout(local_size_x = 8, local_size_y = 8) in;
#if AT == AT_PIXELS
#include "interpolate.glsl"
#endif
#include "light.glsl"

layout(std140, binding = 0) uniform Parameters {
  vec3 eyeWorld;
  int published;  // Eq. 10 as printed
};
layout(binding = 0) uniform sampler2D gPosition;
layout(binding = 1) uniform sampler2D gNormal;
#if AT == AT_PIXELS
layout(binding = 2) uniform sampler2D gGeometricNormal;
#endif
#if DIFFUSE
layout(binding = 3) uniform sampler2D gDiffuse;
layout(binding = 4) uniform sampler2D diffuseLight;  // of points; AT vertices: of pixels
layout(binding = 5) uniform sampler2D diffusePlace;
layout(binding = 0, rgba32f) uniform writeonly image2D diffuseImage;
#endif
#if GLOSSY
layout(binding = 6) uniform sampler2D gSpecular;
layout(binding = 7) uniform sampler2D glossyLight;
layout(binding = 11) uniform sampler2D glossyPlace;
layout(binding = 1, rgba32f) uniform writeonly image2D glossyImage;
#endif

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, textureSize(gPosition, 0)))) return;
  vec4 position = texelFetch(gPosition, pixel, 0), normal = texelFetch(gNormal, pixel, 0);
#if AT == AT_PIXELS
  SeenSurface seen = SeenSurface(position.xyz, normal.xyz, texelFetch(gGeometricNormal, pixel, 0).w);
#endif
#if DIFFUSE
  vec3 diffuse = vec3(0.0), albedo = texelFetch(gDiffuse, pixel, 0).rgb;
  if (position.w > 0.0 && any(greaterThan(albedo, vec3(0.0)))) {
#if AT == AT_PIXELS
    Nearest nearest = nearestPoints(seen, -1.0);
    AveragedLight light = interpolated(seen, nearest, diffuseLight, diffusePlace, false, false, INTERPOLATE == INTERPOLATE_PLAIN);
#else
    AveragedLight light = AveragedLight(texelFetch(diffuseLight, pixel, 0), texelFetch(diffusePlace, pixel, 0).xyz);
#endif
    diffuse = albedo * light.light.rgb;
#if INTERPOLATE == INTERPOLATE_AVERAGED
    diffuse *= cosineTo(light.place, position.xyz, normal.xyz);
#endif
    vec3 path = light.place - position.xyz;
    if (published != 0) diffuse = dividedAsPublished(diffuse, dot(path, path));
  }
  imageStore(diffuseImage, pixel, vec4(diffuse, 1.0));
#endif
#if GLOSSY
  vec3 glossy = vec3(0.0);
  vec4 specular = texelFetch(gSpecular, pixel, 0);
  if (position.w > 0.0 && any(greaterThan(specular.rgb, vec3(0.0)))) {
#if AT == AT_PIXELS
    Nearest nearest = nearestPoints(seen, specular.w);
    AveragedLight light = interpolated(seen, nearest, glossyLight, glossyPlace, true, true, false);
#else
    AveragedLight light = AveragedLight(texelFetch(glossyLight, pixel, 0), texelFetch(glossyPlace, pixel, 0).xyz);
#endif
    vec3 path = light.place - position.xyz, view = position.xyz - eyeWorld;
    float distanceSquared = dot(path, path), viewSquared = dot(view, view);
    if (distanceSquared > 0.0 && viewSquared > 0.0 && light.light.w > 0.0 && dot(path, normal.xyz) > 0.0) {
      vec3 mirror = reflect(view * inversesqrt(viewSquared), normal.xyz);
      glossy = specular.rgb * light.light.rgb * lobeCosine(light.light.w - 1.0, dot(mirror, path) * inversesqrt(distanceSquared));
      if (published != 0) glossy = dividedAsPublished(glossy, distanceSquared);
    }
  }
  imageStore(glossyImage, pixel, vec4(glossy, 1.0));
#endif
}
