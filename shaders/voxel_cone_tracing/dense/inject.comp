#version 450
// Crassin et al. 2011, Sec. 6; thesis 004 Sec. 4.2.1, Listing 4.8: the light that each fragment reflects. For each voxel, it counts the
// fragments and finds the largest radiance, which add.comp needs for the average. Deviates: what a Phong lobe reflects is added, as if it
// left to all sides; the papers' fragments are diffuse.
//
// DIRECTIONS: both sides separately, the side of the normal first.
#pragma lumivox axis DIRECTIONS 0 1
#pragma lumivox require PLACES != clipmap || (DIRECTIONS && !CHANGED)
#pragma lumivox require !REFLECTED || (!CHANGED && PLACES != clipmap)

layout(local_size_x = 64) in;
#include "../fragment_light.glsl"
#include "../sums.glsl"

#if DIRECTIONS
layout(std430, binding = 4) buffer DirectionalSums { VoxelDirections directions[]; };
#else
layout(std430, binding = 4) buffer Sums { VoxelSums sums[]; };
#endif

float largest(vec3 value) { return max(value.r, max(value.g, value.b)); }

void main() {
  uint index;
  if (!takenFragment(index)) return;
  VoxelFragment fragment = fragments[index];
  vec3 albedo = albedoOf(fragment);
  vec4 lobe = glossy != 0 ? lobeOf(fragment) : vec4(0.0);
  bool hasLobe = any(greaterThan(lobe.rgb, vec3(0.0)));
  vec3 emitted = emittedBy(fragment);
  float ambientByLobe = hasLobe ? ambient * phongAlbedo(lobe.w) : 0.0;
  KnownLight known = knownLightOf(index, fragment, twoSided != 0);
  SidesLit lit = kUnlit;
#if LIGHTS
  lit = litAt(fragment, known, hasLobe ? lobe.w : -1.0);
#endif
  ivec3 voxel = unpackVoxel(fragment.voxel);
  uint place = sumsAt(voxel);
  float most = mostRadianceIn(voxel);
#if DIRECTIONS
  vec3 front = albedo / kPi * (ambient + lit.front) + lobe.rgb / kPi * (ambientByLobe + lit.frontByLobe) + emitted;
  vec3 back = albedo / kPi * (ambient + lit.back) + lobe.rgb / kPi * (ambientByLobe + lit.backByLobe);
  vec3 sides[2] = vec3[2](front + (known.side == 0 ? known.radiance : vec3(0.0)), back + (known.side == 0 ? vec3(0.0) : known.radiance));
  float brightest = 0.0;
  for (int side = 0; side < 2; ++side) {
    vec3 radiance = min(sides[side], most);
    brightest = max(brightest, largest(radiance));
    for (int channel = 0; channel < 3; ++channel) radiances[6 * index + 3 * side + channel] = radiance[channel];
  }
  atomicAdd(directions[place].fragments, 1u);
  atomicMax(directions[place].brightest, floatBitsToUint(brightest));
#else
  vec3 radiance = albedo / kPi * (ambient + lit.front + lit.back);  // ambient: thesis Fig. 66
  radiance = min(radiance + lobe.rgb / kPi * (ambientByLobe + lit.frontByLobe + lit.backByLobe), most);
  radiance = min(radiance + known.radiance + emitted, most);
  for (int channel = 0; channel < 3; ++channel) radiances[3 * index + channel] = radiance[channel];
  atomicAdd(sums[place].fragments, 1u);
  atomicMax(sums[place].brightest, floatBitsToUint(largest(radiance)));
#endif
}
