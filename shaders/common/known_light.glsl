// Direct light that fragments are known to reflect on the side that the camera saw: Mavridis & Papaioannou 2011, Sec. 3.2. Included after
// common/fragments.glsl and, to light the sides without known light, after common/two_sided_light.glsl. C++ side:
// VoxelFragments::reflected in framework/include/lumivox/pipeline/ports/voxel_fragments.h.
#pragma lumivox axis REFLECTED 0 1
#ifndef LUMIVOX_KNOWN_LIGHT
#define LUMIVOX_KNOWN_LIGHT

#if REFLECTED
layout(std430, binding = 7) readonly buffer Reflected { uint reflected[]; };  // a word for each of the first fragments
#endif

struct KnownLight {
  bool known;     // the light of one side is known; false: of neither side
  int side;       // 0: the side of the normal; 1: the back
  vec3 radiance;  // that leaves this side, W/(sr m^2)
};
const KnownLight kNoLightKnown = KnownLight(false, 0, vec3(0.0));

// With twoSided off, backs reflect nothing, even if their light is known.
KnownLight knownLightOf(uint index, VoxelFragment fragment, bool twoSided) {
#if REFLECTED
  uint word = index < uint(reflected.length()) ? reflected[index] : kNotKnown;
  if (word == kNotKnown) return kNoLightKnown;
  int side = (fragment.offset & kSeenBehind) != 0u ? 1 : 0;
  return KnownLight(true, side, side == 0 || twoSided ? unpackShared(word) : vec3(0.0));
#else
  return kNoLightKnown;
#endif
}

// Irradiance of the two sides of a surface, W/m^2, and the same times the share that the surface's Phong lobe reflects of it.
struct SidesLit {
  vec3 front, back;
  vec3 frontByLobe, backByLobe;
};
const SidesLit kUnlit = SidesLit(vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));

#ifdef LUMIVOX_TWO_SIDED_LIGHT
#include "common/brdf.glsl"

// Adds the light of the first lightCount lights, but only to the sides without known light. `exponent`: of the lobe; negative: no lobe.
void addArrivingBeside(KnownLight known, int lightCount, vec3 posWorld, vec3 normal, float exponent, bool twoSided, int mediumSteps,
                       inout SidesLit lit) {
  bool onlyBack = known.known && known.side == 0;
  if (onlyBack && !twoSided) return;
  for (int i = 0; i < lightCount; ++i) {
    bool behind;
    float cosSurface;
    vec3 arriving = irradianceFrom(lights[i], posWorld, onlyBack ? -normal : normal, twoSided && !known.known, mediumSteps, behind, cosSurface);
    vec3 byLobe = exponent >= 0.0 ? arriving * phongAlbedo(exponent, cosSurface) : vec3(0.0);
    if (behind != onlyBack) {
      lit.back += arriving;
      lit.backByLobe += byLobe;
    } else {
      lit.front += arriving;
      lit.frontByLobe += byLobe;
    }
  }
}
#endif

#endif
