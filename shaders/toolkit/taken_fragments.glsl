// The fragments that a shader takes: all of a list, or (CHANGED) only those in changed cells. Included after the local size, which is along
// x alone.
// C++ side: forEachFragment(), forEachChanged() in framework/include/lumivox/toolkit/.
#ifndef LUMIVOX_TAKEN_FRAGMENTS
#define LUMIVOX_TAKEN_FRAGMENTS
#pragma lumivox axis CHANGED 0 1
#include "common/fragments.glsl"
#if CHANGED
layout(std430, binding = 13) readonly buffer ChangedCount { uint changedCount; };
layout(std430, binding = 14) readonly buffer ChangedFragments { uint changedFragments[]; };
#endif

// The fragment of this thread; false behind the last.
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
