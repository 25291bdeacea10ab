// Radiance of the surface at the hit point of a ray, read from the reflective shadow maps: thesis 004, Sec. 3.2.3 and Listing 4.49.
#include "common/lights.glsl"
#ifndef MAP_LOBES
#define MAP_LOBES 0  // 1: the map holds lobes, which are among its flux
#endif
#if MAP_LOBES
#include "common/brdf.glsl"
layout(binding = 13) uniform sampler2DArray rsmSpecular;
#endif

layout(std430, binding = 6) readonly buffer Views { mat4 views[]; };
layout(binding = 3) uniform sampler2DArray rsmPosition;
layout(binding = 4) uniform sampler2DArray rsmNormal;
layout(binding = 5) uniform sampler2DArray rsmFlux;

layout(constant_id = 0) const int taps = 1;       // 1: the texel at the point; 4: bilinear over four texels
layout(constant_id = 1) const int frontTest = 1;  // whether surfaces that face away from the receiver contribute nothing
// 1: the tests of Listing 4.49 as printed. The tolerance enlarges only the side of the texel. The slant of the texel is measured against
// the direction of a sun or spot light, and counts only with frontTest. The receiver is its surface
// point, an offset away from its ray origins.
layout(constant_id = 6) const int printedTests = 0;

layout(std140, binding = 2) uniform BackProjection {
  float voxelDiagonal;  // m
  float tolerance;      // factor on the distance of a surface from the point; below 0: no test
  float cap;            // largest allowed distance, m; below 0: unlimited
  float leastCosine;    // lower limit of the cosine between a surface's normal and its light
  int firstLight;       // light samples that this dispatch adds
  int lightsAtOnce;
};

// Whether a texel shows the surface at the point, to a receiver on its lit side.
bool showsPoint(LightSample light, ivec3 texel, float depth, vec3 point, vec3 toReceiver) {
  vec4 position = texelFetch(rsmPosition, texel, 0);
  vec4 normalArea = texelFetch(rsmNormal, texel, 0);
  if (!(position.w > 0.0 && normalArea.w > 0.0)) return false;
  if (frontTest != 0 && dot(normalArea.xyz, toReceiver) < 0.0) return false;
  if (tolerance >= 0.0) {
    bool parallel = light.kind == kLightDirectional;
    vec3 toLight = parallel ? -light.direction : normalize(light.position - position.xyz);
    float width = light.texelWidth * (parallel ? 1.0 : depth);
    if (printedTests != 0 && light.kind == kLightSpot) toLight = -light.direction;
    float slant = printedTests != 0 && frontTest == 0 ? 1.0 : max(dot(normalArea.xyz, toLight), leastCosine);
    float side = width / slant;
    float allowed = max(voxelDiagonal, printedTests != 0 ? tolerance * side : side);
    if (cap >= 0.0) allowed = min(allowed, cap);
    if (distance(point, position.xyz) > (printedTests != 0 ? 1.0 : tolerance) * allowed) return false;
  }
  return true;
}

// Radiance of the diffuse surface of a texel, W/(sr m^2), the same in all directions: its exitance, flux over area, divided by pi.
vec3 diffuseOfTexel(ivec3 texel) { return texelFetch(rsmFlux, texel, 0).rgb / (kPi * texelFetch(rsmNormal, texel, 0).w); }

vec3 radianceOfTexel(LightSample light, ivec3 texel, float depth, vec3 point, vec3 toReceiver) {
  if (!showsPoint(light, texel, depth, point, toReceiver)) return vec3(0.0);
  vec3 radiance = diffuseOfTexel(texel);
#if MAP_LOBES
  // The lobe in this direction, in place of what it reflects into all directions alike.
  vec4 specular = texelFetch(rsmSpecular, texel, 0);
  if (any(greaterThan(specular.rgb, vec3(0.0)))) {
    vec3 normal = texelFetch(rsmNormal, texel, 0).xyz, toLight;
    vec3 perpendicular = arrivingIrradiance(light, texelFetch(rsmPosition, texel, 0).xyz, toLight);
    float cosine = max(dot(normal, toLight), 0.0);
    vec3 lobe = phongLobe(specular.rgb, specular.w, normal, normalize(toReceiver), toLight);
    radiance += perpendicular * cosine * (lobe - specular.rgb * (phongAlbedo(specular.w, cosine) / kPi));
  }
  radiance = max(radiance, vec3(0.0));
#endif
  return radiance;
}

// Layer and position, in texels, of a point in the view of a light; false outside the view. `depth`: along the view direction, m.
bool placeInView(LightSample light, vec3 point, out int layer, out vec2 place, out float depth) {
  layer = light.firstView;
  if (light.firstView < 0) return false;
  if (light.viewCount > 1) layer += cubeFace(point - light.position);
  vec4 clip = views[layer] * vec4(point, 1.0);
  depth = clip.w;
  if (!(clip.w > 0.0)) return false;  // behind the light
  vec2 projected = clip.xy / clip.w;
  vec2 size = vec2(textureSize(rsmPosition, 0).xy);
  place = vec2(0.5 + 0.5 * projected.x, 0.5 - 0.5 * projected.y) * size;
  return all(greaterThanEqual(place, vec2(0.0))) && all(lessThanEqual(place, size));
}

// The texel at a place. The last texel of a face includes the far edge of the face.
ivec3 texelAt(vec2 place, int layer) { return ivec3(min(ivec2(place), textureSize(rsmPosition, 0).xy - 1), layer); }

// Radiance of the surface at a point due to one light, of any kind.
vec3 backProjected(LightSample light, vec3 point, vec3 toReceiver) {
  int layer;
  vec2 place;
  float depth;
  if (!placeInView(light, point, layer, place, depth)) return vec3(0.0);
  if (taps == 1) return radianceOfTexel(light, texelAt(place, layer), depth, point, toReceiver);
  ivec2 size = textureSize(rsmPosition, 0).xy;
  vec2 low = floor(place - 0.5), share = place - 0.5 - low;
  vec3 sum = vec3(0.0);
  for (int i = 0; i < 4; ++i) {
    ivec2 step = ivec2(i & 1, i >> 1);
    vec2 weight = mix(1.0 - share, share, vec2(step));
    ivec2 texel = clamp(ivec2(low) + step, ivec2(0), size - 1);
    sum += weight.x * weight.y * radianceOfTexel(light, ivec3(texel, layer), depth, point, toReceiver);
  }
  return sum;
}

vec3 radianceAt(vec3 point, vec3 toReceiver) {
  vec3 sum = vec3(0.0);
  for (int i = firstLight; i < firstLight + lightsAtOnce; ++i) sum += backProjected(lights[i], point, toReceiver);
  return sum;
}
