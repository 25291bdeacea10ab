#version 450
// Sec. 3.2 step 1 (Eq. 6 to 8): averages all lights, seen from each point, into one light: the sum of the light that the point reflects,
// and a weighted mean of the positions. Sec. 4.2: in chunks whose lights all points read together, from a cache (METHOD cached, published)
// or from shared memory (METHOD shared). PUBLISHED: Eq. 4 and 5 as printed. SIGHT: each light counts as far as the point's directions show
// it, and directions without a disc bring the environment.
#pragma lumivox axis LOBE diffuse glossy
#pragma lumivox axis METHOD cached shared
#pragma lumivox axis PUBLISHED 0 1
#pragma lumivox axis LOBED 0 1  // lights may have lobes
#pragma lumivox require !PUBLISHED || !LOBED
#pragma lumivox axis SIGHT 0 1
#pragma lumivox require !SIGHT || !PUBLISHED
layout(local_size_x = 64) in;
#include "common/list.glsl"
#include "surface_points.glsl"
#include "discs.glsl"
#include "light.glsl"
#if LOBED
#include "common/surface_lobe.glsl"
#endif
#if SIGHT
#include "directions/ask.glsl"
#include "common/environment.glsl"
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
#if SIGHT
layout(std140, binding = 1) uniform Sky {
  vec3 environment;  // W/(sr m^2)
  float skyDistance; // m: where it lies if there is no light
};
#endif
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
#if SIGHT
  uint index;
  vec3 tangent, binormal;
#endif
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
#if SIGHT
  float visible = dot(offset, point.normal) > 0.0 && dot(offset, light.normal.xyz) < 0.0
                      ? visibleShare(point.index, light.positionArea.xyz, offset, point.tangent, point.binormal)
                      : 0.0;
#else
  const float visible = 1.0;
#endif
#if LOBE == LOBE_DIFFUSE
  float share = visible * sharePerArea(light, point.position, point.normal);
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
    share = visible * lobeReflected(exponent, width, point.normal, point.toEye, toLight);
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

#if SIGHT
// The environment in the directions that no disc occludes, each of the form factor 1 / 64, as far away as the lights are.
void addSky(Receiver point, inout Sums sums) {
  if (environment == vec3(0.0)) return;
  const float kFormFactor = 1.0 / float(kSightSide * kSightSide);
  float squared = dot(sums.square, vec3(1.0));
  float away = sums.offset.w > 64.0 * smallWeight && squared > 0.0 ? sqrt(squared / sums.offset.w) : skyDistance;
  for (int i = 0; i < kSightSide * kSightSide; ++i) {
    if (nearest[int(point.index) * kSightSide * kSightSide + i] != kSeesNothing) continue;
    vec3 local = sightDirection(ivec2(i % kSightSide, i / kSightSide));
    vec3 toSky = local.x * point.tangent + local.y * point.binormal + local.z * point.normal;
    float width = min(kFormFactor / local.z, 1.0);
    vec3 sky = environmentAlong(environment, toSky, sqrt(width / max(1.0 - width, 1e-6)));
#if LOBE == LOBE_DIFFUSE
    float share = kFormFactor;
#else
    float share = lobeReflected(point.exponent, width, point.normal, point.toEye, toSky);
#endif
    sums.light.rgb += share * sky;
    if (share > 0.0) sums.light.w = max(sums.light.w, max(sky.r, max(sky.g, sky.b)));
    vec3 offset = away * toSky;
    sums.offset += share * vec4(offset, 1.0);
    sums.square += share * offset * offset;
  }
}
#endif

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
  Receiver point = Receiver(texelFetch(pointPosition, texel, 0).xyz, texelFetch(pointNormal, texel, 0).xyz, vec3(0.0), 0.0
#if SIGHT
                            , index, vec3(0.0), vec3(0.0)
#endif
  );
#if SIGHT
  if (isPoint) planeAxes(point.normal, point.tangent, point.binormal);
#endif
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
#if SIGHT
  if (reflects) addSky(point, all);
#endif
  vec3 offset = all.offset.w > 0.0 ? all.offset.xyz / all.offset.w : vec3(0.0);
  vec3 variance = all.offset.w > 0.0 ? max(all.square / all.offset.w - offset * offset, vec3(0.0)) : vec3(0.0);
  float radius = 2.0 * sqrt(max(variance.x, max(variance.y, variance.z)));  // Sec. 3.3: for a uniform disc, its radius
#if LOBE == LOBE_GLOSSY
  all.light.w = reflects ? 1.0 + resolvedExponent(point.exponent, dot(offset, offset), pointSpacing, resolved) : 0.0;
#endif
  imageStore(lightImage, texel, all.light);
  imageStore(placeImage, texel, vec4(point.position + offset, radius));
}
