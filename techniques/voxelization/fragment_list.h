// Lists of fragments that begin with the fragments of another pass.
#pragma once

#include <cstdint>

#include "voxeliser.h"

namespace lumivox::voxelization {

/// Work groups of kWorkGroupSize threads for so many items; the shader counts along x, then along y.
glm::uvec3 workGroupsFor(std::uint64_t items);

/// A list in this grid with room for `more` fragments behind those of `base`, and those copied: all on the
/// device. Without a base it is empty. Error when it would be too large.
VoxelFragments listBehind(PassContext& frame, const GridPlacement& grid, const VoxelFragments* base,
                          std::uint64_t more);

/// Turns the number of fragments into the arguments of a dispatch over them.
void finishList(PassContext& frame, const VoxelFragments& list);

}  // namespace lumivox::voxelization
