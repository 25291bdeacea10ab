#version 450
// Sec. 3.2 step 1 (Eq. 6 to 8): averages all lights, seen from each point, into one light: the sum of the light that the point reflects,
// and a weighted mean of the positions. Sec. 4.2: in chunks whose lights all points read together, from a cache (METHOD cached, published)
// or from shared memory (METHOD shared). PUBLISHED: Eq. 4 and 5 as printed.
#pragma lumivox axis LOBE diffuse glossy
#pragma lumivox axis METHOD cached shared
#pragma lumivox axis PUBLISHED 0 1
#pragma lumivox axis LOBED 0 1  // lights may have lobes
#pragma lumivox require !PUBLISHED || !LOBED
layout(local_size_x = 64) in;
#include "common/list.glsl"
#include "surface_points.glsl"
#include "discs.glsl"
#include "light.glsl"
#if LOBED
#include "common/surface_lobe.glsl"
#endif

const int kChunk = 128;  // K_cache, Sec. 4.2; gather.cpp

layout(std140, binding = 0) uniform Parameters {
  vec3 eyeWorld;
  int firstLight, lights;   // range of lights in the buffer that this dispatch adds
  float smallWeight;        // epsilon of Eq. 7
  int begins, ends;         // 1: the first dispatch; 1: the last dispatch
  float resolved;           // beta: limits an exponent by the spacing of points; 0: no limit
  float factor;             // c of Eq. 5, PUBLISHED
  float overlapping;        // number of lights that may lie at the same position, whose radiance adds up
};
layout(std430, binding = 0) readonly buffer SurfaceLights { SurfaceLight surfaceLights[]; };
layout(binding = 0, rgba32f) uniform image2D sumImage;           // rgb sum of the light; w radiance of the brightest light
layout(binding = 1, rgba32f) uniform image2D offsetImage;        // xyz sum of weighted offsets; w sum of weights
layout(binding = 2, rgba32f) uniform image2D squareImage;        // xyz sum of weighted squared offsets
layout(binding = 3, rgba32f) uniform writeonly image2D lightImage;
layout(binding = 4, rgba32f) uniform writeonly image2D placeImage;

struct Sums {
  vec4 light, offset;
  vec3 square;
};

struct Receiver {
  vec3 position, normal, toEye;
  float exponent;  // -1: reflects nothing
};

#if METHOD == METHOD_SHARED
const int kTogether = 64;  // one light per invocation
shared SurfaceLight near[kTogether];
#endif

void add(Receiver point, SurfaceLight light, inout Sums sums) {
  vec3 offset = light.positionArea.xyz - point.position;
  float area = light.positionArea.w;
  if (area <= 0.0) return;
#if LOBED
  light.flux.rgb = fluxTowards(light, point.position);
#endif
  vec3 exitance = light.flux.rgb / area;
  float weight = smallWeight;
#if LOBE == LOBE_DIFFUSE
  float share = sharePerArea(light, point.position, point.normal);
  weight += share * area;
#if PUBLISHED
  vec3 reflected = light.flux.rgb * (share * area / kPi);  // Eq. 4 prints the flux where it means the exitance
#else
  vec3 reflected = light.flux.rgb * (share / kPi);
#endif
#else
  float share = 0.0, distanceSquared = dot(offset, offset);
  if (distanceSquared > 0.0) {
    vec3 toLight = offset * inversesqrt(distanceSquared);
    float width = discWidth(area, -dot(toLight, light.normal.xyz), distanceSquared);
#if PUBLISHED
    share = lobeReflectedAsPublished(point.exponent, width, dot(reflect(-point.toEye, point.normal), toLight), factor);
    weight += width * lobeCosine(point.exponent, dot(reflect(-point.toEye, point.normal), toLight));
#else
    float exponent = resolvedExponent(point.exponent, distanceSquared, pointSpacing, resolved);
    share = lobeReflected(exponent, width, point.normal, point.toEye, toLight);
    weight += share;
#endif
  }
#if PUBLISHED
  vec3 reflected = light.flux.rgb * share;
#else
  vec3 reflected = exitance * (share / kPi);
#endif
#endif
  sums.light.rgb += reflected;
  if (share > 0.0) sums.light.w = max(sums.light.w, overlapping / kPi * max(exitance.r, max(exitance.g, exitance.b)));
  sums.offset += weight * vec4(offset, 1.0);
#if PUBLISHED
  vec3 own = vec3(0.0);
#else
  // Variance of a disc about its centre: a quarter of its squared radius along each axis in its plane.
  vec3 own = area / (4.0 * kPi) * (1.0 - light.normal.xyz * light.normal.xyz);
#endif
  sums.square += weight * (offset * offset + own);
}

void addTo(inout Sums all, Sums some) {
  all.light = vec4(all.light.rgb + some.light.rgb, max(all.light.w, some.light.w));
  all.offset += some.offset;
  all.square += some.square;
}

void main() {
  uint index = listIndex();
  bool isPoint = index < uint(pointCount);
  ivec2 texel = pointTexel(isPoint ? index : 0u);
  vec3 material = texelFetch(pointRadius, texel, 0).xyz;
  Receiver point = Receiver(texelFetch(pointPosition, texel, 0).xyz, texelFetch(pointNormal, texel, 0).xyz, vec3(0.0), 0.0);
#if LOBE == LOBE_GLOSSY
  vec3 path = eyeWorld - point.position;
  float pathLength = length(path);
  point.toEye = pathLength > 0.0 ? path / pathLength : point.normal;
  point.exponent = material.z > 0.0 && dot(point.toEye, point.normal) > 0.0 ? material.y : -1.0;
#endif
  bool reflects = isPoint && point.exponent >= 0.0 && point.normal != vec3(0.0);
  const Sums kNothing = Sums(vec4(0.0), vec4(0.0), vec3(0.0));
  Sums all = kNothing;
  if (begins == 0) all = Sums(imageLoad(sumImage, texel), imageLoad(offsetImage, texel), imageLoad(squareImage, texel).xyz);
  for (int first = 0; first < lights; first += kChunk) {
    Sums chunk = kNothing;
    int end = min(first + kChunk, lights);
#if METHOD == METHOD_CACHED
    if (reflects)
      for (int i = first; i < end; ++i) add(point, surfaceLights[firstLight + i], chunk);
#else
    for (int group = first; group < end; group += kTogether) {
      int own = group + int(gl_LocalInvocationIndex);
      barrier();
      if (own < end) near[gl_LocalInvocationIndex] = surfaceLights[firstLight + own];
      barrier();
      if (reflects)
        for (int i = 0; i < min(kTogether, end - group); ++i) add(point, near[i], chunk);
    }
#endif
    addTo(all, chunk);
  }
  if (!isPoint) return;
  if (ends == 0) {
    imageStore(sumImage, texel, all.light);
    imageStore(offsetImage, texel, all.offset);
    imageStore(squareImage, texel, vec4(all.square, 0.0));
    return;
  }
  vec3 offset = all.offset.w > 0.0 ? all.offset.xyz / all.offset.w : vec3(0.0);
  vec3 variance = all.offset.w > 0.0 ? max(all.square / all.offset.w - offset * offset, vec3(0.0)) : vec3(0.0);
  float radius = 2.0 * sqrt(max(variance.x, max(variance.y, variance.z)));  // Sec. 3.3: for a uniform disc, its radius
#if LOBE == LOBE_GLOSSY
  all.light.w = reflects ? 1.0 + resolvedExponent(point.exponent, dot(offset, offset), pointSpacing, resolved) : 0.0;
#endif
  imageStore(lightImage, texel, all.light);
  imageStore(placeImage, texel, vec4(point.position + offset, radius));
}
