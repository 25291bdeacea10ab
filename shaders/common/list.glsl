// Items of a list longer than a row of work groups may be. C++ side: framework/include/lumivox/pipeline/list_dispatch.h. Included after
// the local size, which is along x alone.
#ifndef LUMIVOX_LIST
#define LUMIVOX_LIST

// At or above the number of items in the last groups.
uint listIndex() { return (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * gl_WorkGroupSize.x + gl_LocalInvocationID.x; }

#endif
