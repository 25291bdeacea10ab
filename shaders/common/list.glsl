// Items of a list that may be longer than a row of work groups. Included after the local size, which is along x alone. C++ side:
// PassContext::dispatchList() in framework/include/lumivox/pipeline/pass.h.
#ifndef LUMIVOX_LIST
#define LUMIVOX_LIST

// Most work groups along an axis that OpenGL promises (4.5, table 23.72).
const uint kMostGroups = 65535u;

// Work groups along x and y for so many of them: full rows, the last of which may be too long; one at least.
uvec2 rowsOfGroups(uint groups) {
  return uvec2(min(max(groups, 1u), kMostGroups), max((groups + kMostGroups - 1u) / kMostGroups, 1u));
}

// At or above the number of items in the last groups.
uint listIndex() { return (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * gl_WorkGroupSize.x + gl_LocalInvocationID.x; }

#endif
