// Radiance of the environment by direction. C++ side: EnvironmentBinding in lumivox/toolkit/environment.h, OctahedralEnvironment in
// framework/src/scene/octahedral_environment.h.
#ifndef LUMIVOX_ENVIRONMENT
#define LUMIVOX_ENVIRONMENT
layout(constant_id = 20) const int environmentMap = 0;  // 1: the environment differs by direction; 0: nothing is read

layout(std430, binding = 15) readonly buffer Environment {
  int environmentSide;       // of level 0, a power of two
  int environmentLevelCount;
  vec4 environmentRadiance[];  // W/(sr m^2), level 0 first
};

// Texel of a level of this side; beyond an edge lies the texel across the fold.
vec3 environmentTexel(ivec2 texel, int side) {
  if (texel.x < 0 || texel.x >= side) texel = ivec2(texel.x < 0 ? -1 - texel.x : 2 * side - 1 - texel.x, side - 1 - texel.y);
  if (texel.y < 0 || texel.y >= side) texel = ivec2(side - 1 - texel.x, texel.y < 0 ? -1 - texel.y : 2 * side - 1 - texel.y);
  // The finer levels have (side0^2 - side^2) 4 / 3 texels.
  int first = (environmentSide * environmentSide - side * side) / 3 * 4;
  return environmentRadiance[first + texel.y * side + texel.x].rgb;
}

vec3 environmentAtLevel(vec2 place, int level) {
  int side = environmentSide >> level;
  vec2 at = place * float(side) - 0.5;
  ivec2 low = ivec2(floor(at));
  vec2 share = at - floor(at);
  return mix(mix(environmentTexel(low, side), environmentTexel(low + ivec2(1, 0), side), share.x),
             mix(environmentTexel(low + ivec2(0, 1), side), environmentTexel(low + ivec2(1, 1), side), share.x), share.y);
}

// Mean radiance within a cone of this half angle; `constant`, the mean over the sphere, where there is no map or no light. A disc of radius t has the variance t^2 / 4 along each
// axis. A texel of width w and the linear weights between texels together have w^2 / 12 + w^2 / 6. Both are equal for w = t. A sphere of n^2
// texels has texels of the mean width sqrt(4 pi) / n.
vec3 environmentAlong(vec3 constant, vec3 direction, float tanHalfAngle) {
  if (environmentMap == 0 || constant == vec3(0.0)) return constant;
  vec2 place = direction.xy / (abs(direction.x) + abs(direction.y) + abs(direction.z));
  if (direction.z < 0.0) place = (1.0 - abs(place.yx)) * vec2(place.x < 0.0 ? -1.0 : 1.0, place.y < 0.0 ? -1.0 : 1.0);
  place = 0.5 * place + 0.5;
  const float kSqrtOfSphere = 3.5449077018110320;
  float level = clamp(log2(max(tanHalfAngle, 1e-6) * float(environmentSide) / kSqrtOfSphere), 0.0, float(environmentLevelCount - 1));
  int finer = int(level);
  vec3 radiance = environmentAtLevel(place, finer);
  float share = level - float(finer);
  return share > 0.0 ? mix(radiance, environmentAtLevel(place, finer + 1), share) : radiance;
}
#endif
