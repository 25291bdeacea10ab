#version 450
// Sec. 3.3: the share of the sphere that represents the averaged light which the discs of all other points occlude, for each point.
#pragma lumivox axis COMBINE product sum nearest mask
#pragma lumivox axis DISCS points surfaces  // of all points, or of other surfaces
layout(local_size_x = 64) in;
#include "common/list.glsl"
#include "surface_points.glsl"
#include "discs.glsl"
#include "squares.glsl"

layout(std140, binding = 0) uniform Parameters {
  int firstOccluder, occluders;  // range of occluders of this dispatch
  int begins, ends;              // 1: the first dispatch; 1: the last dispatch
  int published;                 // 1: the sphere's form factor as printed
};
layout(binding = 0) uniform sampler2D lights;
layout(binding = 1) uniform sampler2D places;
#if DISCS == DISCS_SURFACES
layout(std430, binding = 1) readonly buffer Surfaces { SurfaceLight surfaces[]; };
#endif
layout(std430, binding = 0) buffer States { uvec2 states[]; };  // between dispatches
layout(binding = 0, rgba32f) uniform writeonly image2D occludedImage;

// The occlusion so far. product: x the open share. sum: x the covered share. nearest: x the share that the nearest occluder covers, y its
// squared distance. mask: covered bits.
#if COMBINE == COMBINE_MASK
#define State uvec2
#else
#define State vec2
#endif

#if DISCS == DISCS_SURFACES
vec3 discPosition(int i) { return surfaces[i].positionArea.xyz; }
vec3 discNormal(int i) { return surfaces[i].normal.xyz; }
float discArea(int i) { return surfaces[i].positionArea.w; }
#else
vec3 discPosition(int i) { return texelFetch(pointPosition, pointTexel(uint(i)), 0).xyz; }
vec3 discNormal(int i) { return texelFetch(pointNormal, pointTexel(uint(i)), 0).xyz; }
float discArea(int i) {
  float radius = texelFetch(pointRadius, pointTexel(uint(i)), 0).x;
  return kPi * radius * radius;
}
#endif

void main() {
  uint index = listIndex();
  if (index >= uint(pointCount)) return;
  ivec2 texel = pointTexel(index);
  vec4 light = texelFetch(lights, texel, 0), place = texelFetch(places, texel, 0);
  vec3 position = texelFetch(pointPosition, texel, 0).xyz, normal = texelFetch(pointNormal, texel, 0).xyz;
#if COMBINE == COMBINE_MASK
  State state = begins != 0 ? uvec2(0u) : states[index];
#elif COMBINE == COMBINE_PRODUCT
  State state = begins != 0 ? vec2(1.0, 0.0) : uintBitsToFloat(states[index]);
#else
  State state = begins != 0 ? vec2(0.0, 3.4e38) : uintBitsToFloat(states[index]);
#endif
  vec3 path = place.xyz - position;
  float distanceSquared = dot(path, path), radius = place.w;
  float formFactor = 0.0;
  vec3 toLight = normal;
  if (distanceSquared > 0.0) toLight = path * inversesqrt(distanceSquared);
  if (any(greaterThan(light.rgb, vec3(0.0)))) formFactor = sphereFormFactor(dot(normal, toLight), radius * radius, distanceSquared, published != 0);
  if (formFactor > 0.0) {
    float distance = sqrt(distanceSquared);
    vec3 helper = abs(normal.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0);
    vec3 tangent = normalize(cross(helper, normal)), binormal = cross(normal, tangent);
    Square sphere = squareOf(toLight, formFactor, tangent, binormal);
    for (int i = firstOccluder; i < firstOccluder + occluders; ++i) {
      vec3 toDisc = discPosition(i) - position;
      float discDistanceSquared = dot(toDisc, toDisc);
      float above = dot(toDisc, normal);
      // Most discs are below the surface or behind the light's centre.
      if (!(above > 0.0) || discDistanceSquared >= distanceSquared) continue;
      float discDistance = sqrt(discDistanceSquared);
      vec3 direction = toDisc / discDistance;
      // Only front faces occlude: the back of an open surface has a point of its own, and a solid object would occlude twice.
      float cosAtDisc = -dot(direction, discNormal(i));
      if (!(cosAtDisc > 0.0)) continue;
      Square disc = squareOf(direction, discWidth(discArea(i), cosAtDisc, discDistanceSquared) * above / discDistance,
                             tangent, binormal);
      // Between the near side of the sphere and its centre, occlusion decreases to 0.
      float before = radius > 0.0 ? min(1.0, (distance - discDistance) / radius) : 1.0;
#if COMBINE == COMBINE_MASK
      disc.side *= sqrt(before);
      state |= coveredBits(sphere, disc);
#else
      float covered = before * coveredShare(sphere, disc);
#if COMBINE == COMBINE_PRODUCT
      state.x *= 1.0 - covered;
#elif COMBINE == COMBINE_SUM
      state.x += covered;
#else
      if (covered > 0.0 && discDistanceSquared < state.y) state = vec2(covered, discDistanceSquared);
#endif
#endif
    }
  }
  if (ends == 0) {
#if COMBINE == COMBINE_MASK
    states[index] = state;
#else
    states[index] = floatBitsToUint(state);
#endif
    return;
  }
#if COMBINE == COMBINE_MASK
  float open = 1.0 - float(bitCount(state.x) + bitCount(state.y)) / 64.0;
#elif COMBINE == COMBINE_PRODUCT
  float open = state.x;
#else
  float open = max(0.0, 1.0 - state.x);
#endif
  imageStore(occludedImage, texel, vec4(light.rgb * open, light.w));
}
