#version 450
// Mavridis & Papaioannou 2011, Sec. 3.3, Eq. 3: the light that arrives at the centre of each voxel from all sides, by ray marching.
// OF light: the radiance that voxels emit; OF openness: 1 for rays without a hit within their reach, 0 for the others (Sec. 3.5, Eq. 6).
// WALK steps: tests fixed steps; WALK exact: tests every voxel on the ray (common/bit_grid.glsl). PLANES: as in that file.
// LISTED: only the voxels of a list.
#pragma lumivox axis OF light openness
#pragma lumivox axis WALK steps exact
#pragma lumivox axis LISTED 0 1
#pragma lumivox axis PLANES 0 1
#pragma lumivox require !PLANES || WALK == exact
#pragma lumivox require !PLANES || OF == openness
#pragma lumivox require BIT_RULE == hierarchy
#if OF == OF_LIGHT
#include "common/environment.glsl"
#endif
#include "common/random.glsl"
#include "common/voxel.glsl"
#include "volume.glsl"
#include "surface_sides.glsl"

// Eight invocations share the rays of a voxel; the first one adds up their sums, always in the same order.
layout(local_size_x = 64) in;
#include "common/list.glsl"
const uint kTogether = 8u;

layout(constant_id = 0) const int branchless = 0;  // 1: marches on after the first hit, and ignores later hits
layout(constant_id = 1) const int linear = 0;      // 1: interpolates occupancy and radiance; occupied from 1/2 on
layout(constant_id = 2) const int harmonics = 0;   // 1: a voxel's radiance is the value of its two bands
layout(constant_id = 3) const int sharedSet = 0;   // 1: the same directions for all voxels

layout(std140, binding = 0) uniform Rays {
  vec3 environment;  // W/(sr m^2)
  float guard;       // distance that is skipped at the start, voxels
  uvec2 seed;
  float step;        // voxels
  int mostSteps;     // step limit of the longest ray
  float reach;       // voxels
  int pairs;         // number of pairs of opposite rays
  int firstPair, pairsAtOnce;
  float reflectedUnit;  // W/(sr m^2)
  int bounce;
};
#if WALK == WALK_STEPS
layout(binding = 0) uniform sampler3D opacity;
#endif
#if OF == OF_LIGHT
layout(binding = 1) uniform sampler3D meanNormals;
layout(binding = 2) uniform sampler3D red;
layout(binding = 3) uniform sampler3D green;
layout(binding = 4) uniform sampler3D blue;
layout(binding = 0, rgba32f) uniform image3D redImage;
layout(binding = 1, rgba32f) uniform image3D greenImage;
layout(binding = 2, rgba32f) uniform image3D blueImage;
const int kVolumes = 3;
#else
layout(binding = 0, rgba32f) uniform image3D openImage;
const int kVolumes = 1;
#endif
#if LISTED
layout(std430, binding = 0) readonly buffer ListCount { uint listed; };
layout(std430, binding = 1) readonly buffer List { uint list[]; };
#endif
#include "common/bit_grid.glsl"
#if PLANES
#include "common/voxel_planes.glsl"
#endif

shared vec4 found[gl_WorkGroupSize.x * kVolumes];

// The hit of a ray: a voxel; with `linear`, the eight voxels around `place`.
struct Meeting {
  bool any;
  ivec3 voxel;
  vec3 place;
};

#if WALK == WALK_STEPS
bool isOccupied(ivec3 voxel) { return texelFetch(opacity, voxel, 0).r > occupied; }

float cornerWeight(ivec3 high, vec3 part) {
  vec3 weights = mix(1.0 - part, part, vec3(high));
  return weights.x * weights.y * weights.z;
}
ivec3 cornerOf(int i) { return ivec3(i & 1, i >> 1 & 1, i >> 2); }

bool isOccupiedAt(vec3 place) {
  if (linear == 0) return isOccupied(inVolume(ivec3(place)));
  ivec3 low = ivec3(floor(place - 0.5));
  float share = 0.0;
  for (int i = 0; i < 8; ++i)
    if (isOccupied(inVolume(low + cornerOf(i)))) share += cornerWeight(cornerOf(i), place - 0.5 - vec3(low));
  return share >= 0.5;
}

Meeting meet(vec3 origin, vec3 direction) {
  Meeting result = Meeting(false, ivec3(0), vec3(0.0));
  for (int i = 0; i < mostSteps; ++i) {
    float t = guard + float(i) * step;
    vec3 place = origin + t * direction;
    bool isOnWay = t <= reach && isInVolume(place);
    if (branchless == 0 && !isOnWay) break;
    bool isFirst = isOnWay && !result.any && isOccupiedAt(place);
    result.place = isFirst ? place : result.place;
    result.any = result.any || isFirst;
    if (branchless == 0 && result.any) break;
  }
  result.voxel = inVolume(ivec3(result.place));
  return result;
}
#else
Meeting meet(vec3 origin, vec3 direction) {
  BitHit hit = firstBit(origin + guard * direction, direction, reach - guard, resolution);
  return Meeting(hit.found && reach >= guard, hit.voxel, vec3(hit.voxel) + 0.5);
}
#endif

#if OF == OF_LIGHT
vec3 sentBy(vec4 redSent, vec4 greenSent, vec4 blueSent, vec3 meanNormal, vec3 direction) {
  if (harmonics != 0) {
    vec4 basis = shBasis(direction);
    return max(vec3(dot(redSent, basis), dot(greenSent, basis), dot(blueSent, basis)), 0.0);
  }
  vec3 normal = surfaceNormal(meanNormal, redSent, greenSent, blueSent);
  return sideOf(redSent, greenSent, blueSent, dot(normal, direction) >= 0.0 ? normal : -normal);
}
vec3 normalIn(ivec3 voxel) { return harmonics != 0 ? vec3(0.0) : texelFetch(meanNormals, voxel, 0).xyz; }

vec3 seenAlong(vec3 origin, vec3 direction) {
  Meeting met = meet(origin, direction);
  // Each ray stands for 4 pi over the number of rays: a cone of that width.
  if (!met.any) return environmentAlong(environment, direction, sqrt(2.0 / float(pairs)));
#if WALK == WALK_STEPS
  if (linear != 0) {
    ivec3 low = ivec3(floor(met.place - 0.5));
    vec4 redSum = vec4(0.0), greenSum = vec4(0.0), blueSum = vec4(0.0);
    vec3 normalSum = vec3(0.0);
    float weights = 0.0;
    for (int i = 0; i < 8; ++i) {
      ivec3 voxel = inVolume(low + cornerOf(i));
      if (!isOccupied(voxel)) continue;
      float weight = cornerWeight(cornerOf(i), met.place - 0.5 - vec3(low));
      weights += weight;
      redSum += weight * texelFetch(red, voxel, 0);
      greenSum += weight * texelFetch(green, voxel, 0);
      blueSum += weight * texelFetch(blue, voxel, 0);
      normalSum += weight * normalIn(voxel);
    }
    float scale = reflectedUnit / weights;
    return sentBy(redSum * scale, greenSum * scale, blueSum * scale, normalSum / weights, -direction);
  }
#endif
  return sentBy(texelFetch(red, met.voxel, 0) * reflectedUnit, texelFetch(green, met.voxel, 0) * reflectedUnit,
                texelFetch(blue, met.voxel, 0) * reflectedUnit, normalIn(met.voxel), -direction);
}
#else
float openAlong(vec3 origin, vec3 direction) { return meet(origin, direction).any ? 0.0 : 1.0; }
#endif

// One of each pair of opposite directions: a spiral with equal areas on the upper half of the sphere. Each voxel rotates and shifts it by
// its own random numbers, so that all directions are equally likely.
vec3 directionOf(int pair, vec2 shift) {
  float z = (float(pair) + shift.x) / float(pairs);
  float angle = 2.0 * kPi * fract(float(pair) * (kGoldenAngle / (2.0 * kPi)) + shift.y);
  float sine = sqrt(max(1.0 - z * z, 0.0));
  return vec3(sine * cos(angle), sine * sin(angle), z);
}

void main() {
  uint item = listIndex() / kTogether, lane = gl_LocalInvocationID.x % kTogether;
#if LISTED
  bool isVoxel = item < listed;
  ivec3 voxel = isVoxel ? unpackVoxel(list[item]) : ivec3(0);
#else
  bool isVoxel = item < voxelCount();
  ivec3 voxel = isVoxel ? voxelOfNumber(item) : ivec3(0);
#endif
  vec4 sums[kVolumes];
  for (int v = 0; v < kVolumes; ++v) sums[v] = vec4(0.0);
  if (isVoxel) {
    vec2 shift = unitInterval(hash4(uvec4(sharedSet != 0 ? 0u : 1u + packVoxel(voxel), seed, uint(bounce))).xy);
    vec3 origin = vec3(voxel) + 0.5;
    int end = min(firstPair + pairsAtOnce, pairs);
    for (int pair = firstPair + int(lane); pair < end; pair += int(kTogether)) {
      vec3 direction = directionOf(pair, shift);
      for (int side = 0; side < 2; ++side) {
        vec4 basis = shBasis(direction);
#if OF == OF_LIGHT
        vec3 radiance = seenAlong(origin, direction);
        sums[0] += radiance.r * basis;
        sums[1] += radiance.g * basis;
        sums[2] += radiance.b * basis;
#else
        sums[0] += openAlong(origin, direction) * basis;
#endif
        direction = -direction;
      }
    }
  }
  for (int v = 0; v < kVolumes; ++v) found[kVolumes * gl_LocalInvocationID.x + v] = sums[v];
  barrier();
  if (!isVoxel || lane != 0u) return;
  float weight = 2.0 * kPi / float(pairs);  // 4 pi over the number of rays
  for (uint other = 1u; other < kTogether; ++other)
    for (int v = 0; v < kVolumes; ++v) sums[v] += found[kVolumes * (gl_LocalInvocationID.x + other) + v];
  bool isFirst = firstPair == 0;
#if OF == OF_LIGHT
  imageStore(redImage, voxel, (isFirst ? vec4(0.0) : imageLoad(redImage, voxel)) + weight * sums[0]);
  imageStore(greenImage, voxel, (isFirst ? vec4(0.0) : imageLoad(greenImage, voxel)) + weight * sums[1]);
  imageStore(blueImage, voxel, (isFirst ? vec4(0.0) : imageLoad(blueImage, voxel)) + weight * sums[2]);
#else
  imageStore(openImage, voxel, (isFirst ? vec4(0.0) : imageLoad(openImage, voxel)) + weight * sums[0]);
#endif
}
