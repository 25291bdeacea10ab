// The light that arrives at a fragment, on the side of its normal and behind it: Crassin et al. 2011, Sec. 6; thesis 004 Sec. 4.2.1,
// Listing 4.8. Included after the local size, which is along x only.
// C++ side: DirectLight in techniques/voxel_cone_tracing/direct_light.h.
#pragma lumivox axis LIGHTS 0 1
#pragma lumivox axis SHADOWS 0 1
#pragma lumivox axis MEDIUM none even varying
#pragma lumivox require (!SHADOWS || LIGHTS) && (!LIGHTS || SHADOWS)
#pragma lumivox require MEDIUM == none || LIGHTS
#include "common/brdf.glsl"
#include "bricks.glsl"
#if SHADOWS
#define SHADOW_VIEWS
#endif
#if LIGHTS
#include "common/lights.glsl"
#endif
#if MEDIUM != MEDIUM_NONE
#include "common/media.glsl"
#endif
#if LIGHTS
#include "common/two_sided_light.glsl"
#endif
#include "common/fragments.glsl"
#include "common/known_light.glsl"

layout(std140, binding = 0) uniform Grid {
  vec3 gridLow;     // m
  float voxelSize;  // m
  int lightCount;
  float mostRadiance;   // W/(sr m^2): limit of the radiance of a voxel of this size, however near a light is
  int twoSided;         // 1: light on the back side counts as well
  int mediumSteps;      // step limit through a heterogeneous medium, towards a light
  ivec3 brickCount;
  float ambient;        // irradiance of all surfaces in addition to the lights, W/m^2
  int lightSamples;     // number of points of a fragment's plane inside its voxel that are lit
  int emissive;         // 1: emission of surfaces is stored in the voxels as well
  int glossy;           // 1: what Phong lobes reflect is sent to all sides like diffuse light
};
layout(std430, binding = 2) writeonly buffer Radiances { float radiances[]; };  // r, g, b per fragment or per side of one, W/(sr m^2)
layout(std430, binding = 3) readonly buffer Bricks { Brick bricks[]; };

// The voxel of a fragment: its low corner in world space, and in w its width, m.
#if defined(PLACES_CLIPMAP) && PLACES == PLACES_CLIPMAP  // programs without that axis have dense grids
#include "clipmap/clipmap_stack.glsl"

vec4 voxelOfFragment(VoxelFragment fragment) {
  ivec3 voxel = unpackVoxel(fragment.voxel);
  int level = levelInStack(voxel);
  return vec4(stackOrigin + vec3(voxelOfLevel(voxel, level)) * voxelSizeOf(level), voxelSizeOf(level));
}
float mostRadianceIn(ivec3 voxel) { return stackLimits[levelInStack(voxel)].x; }
#else
vec4 voxelOfFragment(VoxelFragment fragment) { return vec4(gridLow + vec3(unpackVoxel(fragment.voxel)) * voxelSize, voxelSize); }
float mostRadianceIn(ivec3 voxel) { return mostRadiance; }
#endif

// What the front of a fragment emits, W/(sr m^2).
vec3 emittedBy(VoxelFragment fragment) { return emissive != 0 ? emissionOf(fragment) : vec3(0.0); }

// Irradiance by the lights of the sides without known light; 0 of the other sides. It is taken at the fragment's point, or as the mean
// over points of the fragment's plane inside its voxel, so that a shadow edge through the voxel is averaged. These points are evenly
// distributed over the side of the voxel that the plane faces (R2: Roberts 2018). `exponent`: of the surface's lobe; negative: none.
#if LIGHTS
SidesLit litAt(VoxelFragment fragment, KnownLight known, float exponent) {
  SidesLit lit = kUnlit;
  vec4 voxel = voxelOfFragment(fragment);
  vec3 place = unpackOffset(fragment.offset);
  vec3 normal = unpackNormal(fragment.normal);
  const vec2 kR2 = vec2(0.75487766624669276, 0.56984029099805327);
  vec3 along = abs(normal);
  int axis = along.x >= along.y && along.x >= along.z ? 0 : along.y >= along.z ? 1 : 2;
  int side = (axis + 1) % 3, up = (axis + 2) % 3;
  float inside = 0.0;
  // The last turn takes the fragment's own point, if no point of the plane lies in the voxel.
  for (int i = lightSamples <= 1 ? lightSamples : 0; i <= lightSamples; ++i) {
    vec3 point = place;
    if (i < lightSamples) {
      vec2 across = fract(0.5 + float(i) * kR2);
      point[side] = across.x;
      point[up] = across.y;
      point[axis] -= (normal[side] * (across.x - place[side]) + normal[up] * (across.y - place[up])) / normal[axis];
      if (point[axis] < 0.0 || point[axis] > 1.0) continue;
    } else if (inside > 0.0) {
      continue;
    }
    inside += 1.0;
    addArrivingBeside(known, lightCount, voxel.xyz + point * voxel.w, normal, exponent, twoSided != 0, mediumSteps, lit);
  }
  lit.front /= inside;
  lit.back /= inside;
  lit.frontByLobe /= inside;
  lit.backByLobe /= inside;
  return lit;
}
#endif

vec3 albedoOf(VoxelFragment fragment) {
  return vec3(unpackHalf2x16(fragment.albedoRg), unpackHalf2x16(fragment.albedoBCoverage).x);
}
