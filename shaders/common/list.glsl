// Items of a list that may be longer than a row of work groups. Included after the local size, which is along x only. C++ side:
// PassContext::dispatchList() in framework/include/lumivox/pipeline/pass.h.
#ifndef LUMIVOX_LIST
#define LUMIVOX_LIST

// The number of work groups along an axis that every OpenGL implementation supports (4.5, table 23.72).
const uint kMostGroups = 65535u;

// Work groups along x and y for a dispatch of at least `groups` work groups: full rows, so that the
// last row may exceed the list; at least one.
uvec2 rowsOfGroups(uint groups) {
  return uvec2(min(max(groups, 1u), kMostGroups), max((groups + kMostGroups - 1u) / kMostGroups, 1u));
}

// Index of the item of this invocation; in the last groups it may be at or above the number of items.
uint listIndex() { return (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * gl_WorkGroupSize.x + gl_LocalInvocationID.x; }

#endif
