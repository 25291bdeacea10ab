// The fragments that a shader processes: all of a list, or (CHANGED) only those in changed cells. Included after the local size, which is
// along x only.
// C++ side: forEachFragment(), forEachChanged() in framework/include/lumivox/toolkit/.
#ifndef LUMIVOX_TAKEN_FRAGMENTS
#define LUMIVOX_TAKEN_FRAGMENTS
#pragma lumivox axis CHANGED 0 1
#include "common/fragments.glsl"
#if CHANGED
layout(std430, binding = 13) readonly buffer ChangedCount { uint changedCount; };
layout(std430, binding = 14) readonly buffer ChangedFragments { uint changedFragments[]; };
#endif

// The index of this invocation's fragment; false past the last fragment.
bool takenFragment(out uint index) {
  index = listIndex();
#if CHANGED
  if (index >= changedCount) return false;
  index = changedFragments[index];
  return true;
#else
  return index < fragmentCount;
#endif
}

#endif
