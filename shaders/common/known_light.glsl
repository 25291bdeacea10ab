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

#ifdef LUMIVOX_TWO_SIDED_LIGHT
// Like addArriving, but only for the sides without known light.
void addArrivingBeside(KnownLight known, int lightCount, vec3 posWorld, vec3 normal, bool twoSided, int mediumSteps, inout vec3 front,
                       inout vec3 back) {
  vec3 ignored = vec3(0.0);
  if (!known.known) addArriving(lightCount, posWorld, normal, twoSided, mediumSteps, front, back);
  else if (known.side == 1) addArriving(lightCount, posWorld, normal, false, mediumSteps, front, ignored);
  else if (twoSided) addArriving(lightCount, posWorld, -normal, false, mediumSteps, back, ignored);
}
#endif

#endif
