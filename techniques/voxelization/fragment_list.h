// Lists of fragments that begin with the fragments of another pass.
#pragma once

#include <cstdint>

#include "voxelizer.h"

namespace lumivox::voxelization {

/// A list in this grid with room for `more` fragments behind those of `base`, and those copied: all on the
/// device. Without a base it is empty. Error when it would be too large.
VoxelFragments listBehind(PassContext& frame, const GridPlacement& grid, const VoxelFragments* base,
                          std::uint64_t more);

/// Words that count something on the device: how many there are, the groups of a dispatch over them, and how
/// many were wanted, whether there was room for them or not. All but the first are set by finishCount().
gpu::BufferRef countBuffer(PassContext& frame, const char* label);
inline constexpr std::uint64_t kGroupsOffset = sizeof(std::uint32_t),
                               kWantedOffset = 4 * sizeof(std::uint32_t);

/// The first word alone.
void copyCount(PassContext& frame, const gpu::Buffer& from, const gpu::Buffer& to);

/// Turns a number of items into the arguments of a dispatch over them, in groups of kWorkGroupSize. What
/// there was no room for is cut off, and can be told from the number that was wanted.
void finishCount(PassContext& frame, const gpu::Buffer& count, std::uint64_t room);
/// The same for a list of fragments.
void finishList(PassContext& frame, const VoxelFragments& list);

/// Room to take when `wanted` did not fit: that much, and an eighth more when the number changes from frame
/// to frame (`moves`). Error for more fragments than a list can hold.
std::uint64_t roomFor(std::uint64_t wanted, bool moves);

}  // namespace lumivox::voxelization
