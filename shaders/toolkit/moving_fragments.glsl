// One invocation for each fragment of a list, or (MOVING) for each moving fragment; these follow the static ones. Included after the local
// size, which is along x only. C++ side: movingOf() and bindStaticCount() in framework/include/lumivox/toolkit/change_tracking.h.
#pragma lumivox axis MOVING 0 1
#include "common/fragments.glsl"
#if MOVING
layout(std430, binding = 8) readonly buffer StillFragments { uint stillFragments; };
#endif

bool fragmentOf(out uint index) {
  index = listIndex();
  bool isOne = index < fragmentCount;
#if MOVING
  index += stillFragments;
#endif
  return isOne;
}
