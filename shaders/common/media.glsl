// Participating media: their bounds and densities, and the optical depth along rays. C++ side: framework/include/lumivox/toolkit/media.h.
// With the includer's axis MEDIUM at `varying`, densities are in textures; otherwise there are homogeneous media only.
#ifndef LUMIVOX_MEDIA
#define LUMIVOX_MEDIA
#include "common/lights.glsl"
#include "common/phase.glsl"

struct MediumData {
  vec4 lowAnisotropy;      // xyz lowest corner of its bounds, m; w mean cosine g
  vec4 highDensity;        // xyz highest corner, m; w index of the density texture, -1: density 1 everywhere
  vec4 extinction;         // rgb sigma_t at density 1, 1/m
  vec4 scattering;         // rgb sigma_s at density 1, 1/m
  vec4 gridLowVoxel;       // xyz corner of voxel (0,0,0) of the texture, w size of a voxel, m
  vec4 gridExtent;         // xyz size of the texture, m
};
layout(std430, binding = 8) readonly buffer Media {
  int mediumCount;
  int padding0, padding1, padding2;
  MediumData media[];
};

const float kNoReach = 1e30;  // m; reach of rays without an end

// Distances between which a ray of this reach is inside a box; begin >= end if the ray misses the box.
vec2 insideBox(vec3 low, vec3 high, vec3 origin, vec3 direction, float reach) {
  // A ray parallel to a pair of sides never crosses them; either sign of the huge reciprocal separates inside from outside.
  vec3 reciprocal = 1.0 / mix(direction, vec3(1e-30), equal(direction, vec3(0.0)));
  vec3 a = (low - origin) * reciprocal, b = (high - origin) * reciprocal;
  vec3 near = min(a, b), far = max(a, b);
  return vec2(max(max(near.x, near.y), max(near.z, 0.0)), min(min(far.x, far.y), min(far.z, reach)));
}
vec2 insideMedium(int i, vec3 origin, vec3 direction, float reach) {
  return insideBox(media[i].lowAnisotropy.xyz, media[i].highDensity.xyz, origin, direction, reach);
}

// Distances at which a ray first enters and last leaves a medium.
vec2 insideMedia(vec3 origin, vec3 direction, float reach) {
  vec2 range = vec2(reach, 0.0);
  for (int i = 0; i < mediumCount; ++i) {
    vec2 inside = insideMedium(i, origin, direction, reach);
    if (inside.x < inside.y) range = vec2(min(range.x, inside.x), max(range.y, inside.y));
  }
  return range;
}

// The direction to a light sample, and its distance.
void wayToLight(LightSample light, vec3 posWorld, out vec3 direction, out float reach) {
  if (light.kind == kLightDirectional) {
    direction = -light.direction;
    reach = kNoReach;
  } else {
    vec3 path = light.position - posWorld;
    reach = length(path);
    direction = path / max(reach, 1e-30);
  }
}

bool isEven(int i) { return media[i].highDensity.w < 0.0; }

#if defined(MEDIUM_VARYING) && MEDIUM == MEDIUM_VARYING
layout(binding = 8) uniform sampler3D density0;
layout(binding = 9) uniform sampler3D density1;
layout(binding = 10) uniform sampler3D density2;
layout(binding = 11) uniform sampler3D density3;

// Density of a heterogeneous medium.
float densityAt(int i, vec3 posWorld) {
  int which = int(media[i].highDensity.w);
  vec3 texcoord = (posWorld - media[i].gridLowVoxel.xyz) / media[i].gridExtent.xyz;
  if (which == 0) return textureLod(density0, texcoord, 0.0).r;
  if (which == 1) return textureLod(density1, texcoord, 0.0).r;
  if (which == 2) return textureLod(density2, texcoord, 0.0).r;
  return textureLod(density3, texcoord, 0.0).r;
}

// Optical depth of the heterogeneous media along a ray: midpoint rule, one step per voxel but at most `mostSteps`.
vec3 varyingDepth(vec3 origin, vec3 direction, float reach, int mostSteps) {
  vec3 depth = vec3(0.0);
  for (int i = 0; i < mediumCount; ++i) {
    if (isEven(i)) continue;
    vec2 inside = insideMedium(i, origin, direction, reach);
    if (inside.x >= inside.y) continue;
    float extent = inside.y - inside.x;
    int steps = int(clamp(ceil(extent / media[i].gridLowVoxel.w), 1.0, float(mostSteps)));
    float stride = extent / float(steps), sum = 0.0;
    for (int s = 0; s < steps; ++s) sum += densityAt(i, origin + direction * (inside.x + (float(s) + 0.5) * stride));
    depth += media[i].extinction.rgb * (sum * stride);
  }
  return depth;
}
#endif

// Optical depth of the homogeneous media along a ray, exact.
vec3 evenDepth(vec3 origin, vec3 direction, float reach) {
  vec3 depth = vec3(0.0);
  for (int i = 0; i < mediumCount; ++i) {
    if (!isEven(i)) continue;
    vec2 inside = insideMedium(i, origin, direction, reach);
    depth += media[i].extinction.rgb * max(inside.y - inside.x, 0.0);
  }
  return depth;
}

// Optical depth of all media along a ray.
vec3 opticalDepth(vec3 origin, vec3 direction, float reach, int mostSteps) {
  vec3 depth = evenDepth(origin, direction, reach);
#if defined(MEDIUM_VARYING) && MEDIUM == MEDIUM_VARYING
  depth += varyingDepth(origin, direction, reach, mostSteps);
#endif
  return depth;
}

// Transmittance of the media between a light sample and a point.
vec3 transmittanceToLight(LightSample light, vec3 posWorld, int mostSteps) {
  vec3 direction;
  float reach;
  wayToLight(light, posWorld, direction, reach);
  return exp(-opticalDepth(posWorld, direction, reach, mostSteps));
}

#endif
