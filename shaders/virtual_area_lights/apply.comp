#version 450
// Sec. 3.2 steps 3 and 4 in every pixel: the averaged light of the nearest points, reflected by the pixel's own normal and material (Eq. 10).
#pragma lumivox axis DIFFUSE 0 1
#pragma lumivox axis GLOSSY 0 1
#pragma lumivox axis INTERPOLATE averaged plain
#pragma lumivox require DIFFUSE || GLOSSY
layout(local_size_x = 8, local_size_y = 8) in;
#include "interpolate.glsl"
#include "light.glsl"

layout(std140, binding = 0) uniform Parameters {
  vec3 eyeWorld;
  int neighbours;
  int published;  // Eq. 13 as printed
};
layout(binding = 0) uniform sampler2D gPosition;
layout(binding = 1) uniform sampler2D gNormal;
layout(binding = 2) uniform sampler2D gGeometricNormal;
#if DIFFUSE
layout(binding = 3) uniform sampler2D gDiffuse;
layout(binding = 4) uniform sampler2D diffuseLight;
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
  SeenSurface seen = SeenSurface(position.xyz, normal.xyz, texelFetch(gGeometricNormal, pixel, 0).w);
#if DIFFUSE
  vec3 diffuse = vec3(0.0), albedo = texelFetch(gDiffuse, pixel, 0).rgb;
  if (position.w > 0.0 && any(greaterThan(albedo, vec3(0.0)))) {
    Nearest nearest = nearestPoints(seen, -1.0, neighbours);
    AveragedLight light = interpolated(seen, nearest, diffuseLight, diffusePlace, false, false, INTERPOLATE == INTERPOLATE_PLAIN);
    diffuse = albedo * light.light.rgb;
#if INTERPOLATE == INTERPOLATE_AVERAGED
    diffuse *= cosineTo(light.place, seen.position, seen.normal);
#endif
  }
  imageStore(diffuseImage, pixel, vec4(diffuse, 1.0));
#endif
#if GLOSSY
  vec3 glossy = vec3(0.0);
  vec4 specular = texelFetch(gSpecular, pixel, 0);
  if (position.w > 0.0 && any(greaterThan(specular.rgb, vec3(0.0)))) {
    Nearest nearest = nearestPoints(seen, specular.w, neighbours);
    AveragedLight light = interpolated(seen, nearest, glossyLight, glossyPlace, true, published == 0, false);
    vec3 path = light.place - seen.position, view = seen.position - eyeWorld;
    float distanceSquared = dot(path, path), viewSquared = dot(view, view);
    if (distanceSquared > 0.0 && viewSquared > 0.0 && dot(path, seen.normal) > 0.0) {
      vec3 mirror = reflect(view * inversesqrt(viewSquared), seen.normal);
      glossy = specular.rgb * light.light.rgb * lobeCosine(light.light.w - 1.0, dot(mirror, path) * inversesqrt(distanceSquared));
    }
  }
  imageStore(glossyImage, pixel, vec4(glossy, 1.0));
#endif
}
