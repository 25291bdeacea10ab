#version 450
// Reflection by the Phong lobe from the bins of elements. AT pixel: for the elements around a pixel, with the pixel's normal and material.
// AT element: at the elements themselves, for display.comp to blend (published: Dong et al. 2007, Sec. 4.3).
#pragma lumivox axis AT pixel element
#pragma lumivox axis ENVIRONMENT 0 1
#pragma lumivox axis ADDED 0 1
#pragma lumivox axis OUTGOING 0 1
#pragma lumivox require !ADDED || AT == pixel
#include "lobe.glsl"
#if AT == AT_PIXEL
#define KEEPS_NEAREST
#include "neighbours.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 5) uniform sampler2D gPosition;
layout(binding = 6) uniform sampler2D gNormal;
layout(binding = 7) uniform sampler2D gSpecular;
#if ADDED
layout(binding = 3) uniform sampler2D added;  // another image, which is added
#endif
layout(constant_id = 0) const int mostLeaves = 4;  // limit of the leaves whose bins a pixel reads
#else
layout(local_size_x = 64) in;
#include "common/list.glsl"
layout(binding = 3) uniform sampler2D speculars;
#endif
layout(binding = 0, rgba32f) uniform writeonly image2D shownImage;

#if AT == AT_PIXEL
void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(shownImage)))) return;
  vec4 position = texelFetch(gPosition, pixel, 0), specular = texelFetch(gSpecular, pixel, 0);
  vec3 shown = vec3(0.0);
  if (position.w != 0.0 && any(greaterThan(specular.rgb, vec3(0.0)))) {
    vec4 normal = texelFetch(gNormal, pixel, 0);
    Around around = findAround(SurfacePoint(position.xyz, normal.xyz, normal.w > 0.5));
    vec3 toEye = normalize(eyeWorld - position.xyz);
    float shares = 0.0;
    for (int i = 0; i < mostLeaves; ++i) {
      if (!(around.shares[i] > 0.0)) break;
      shown += around.shares[i] * glossyRadiance(around.leaves[i], normal.xyz, toEye, specular);
      shares += around.shares[i];
    }
    if (shares > 0.0) shown /= shares;
  }
#if ADDED
  shown += texelFetch(added, pixel, 0).rgb;
#endif
  imageStore(shownImage, pixel, vec4(shown, 1.0));
}
#else
void main() {
  uint leaf = listIndex();
  if (leaf >= uint(leafCount)) return;
  vec4 specular = texelFetch(speculars, texelOf(leaf), 0);
  vec3 normal = texelFetch(elementNormal, texelOf(leaf), 0).xyz;
  vec3 toEye = normalize(eyeWorld - texelFetch(elementPosition, texelOf(leaf), 0).xyz);
  bool isFront = dot(normal, toEye) >= 0.0;
  vec3 shown = vec3(0.0);
  if (any(greaterThan(specular.rgb, vec3(0.0)))) shown = glossyRadiance(leaf, isFront ? normal : -normal, toEye, specular);
  imageStore(shownImage, texelOf(2u * leaf), vec4(isFront ? shown : vec3(0.0), 1.0));
  imageStore(shownImage, texelOf(2u * leaf + 1u), vec4(isFront ? vec3(0.0) : shown, 1.0));
}
#endif
