// Room for what is summed up over the fragments of each voxel, for the occupied ones alone; and items that
// the device counts and walks without a word to the host. GLSL side: shaders/common/slots_claim.glsl,
// slots_number.glsl and finish_count.glsl, each a whole program that a technique includes in one of its own.
#pragma once

#include <cstdint>

#include "lumivox/pipeline/pass.h"

namespace lumivox {

/// Of the passes that walk what the device counted.
inline constexpr int kCountedGroupSize = 64;

/// Words that count something on the device: how many there are, the groups of a dispatch over them, and how
/// many were wanted, whether there was room for them or not. All but the first are set by finishCount().
gpu::BufferRef countBuffer(PassContext& frame, const char* label);
/// Where the arguments of the dispatch lie in it.
inline constexpr std::uint64_t kGroupsOffset = sizeof(std::uint32_t);

/// Turns a number of items into the arguments of a dispatch over them, in groups of a given size. Items
/// beyond the room are cut off; the wanted number stays readable.
void finishCount(PassContext& frame, const shader::BoundProgram& finish, const gpu::BufferRef& count,
                 std::uint64_t capacity, int itemsOfGroup = kCountedGroupSize);
/// The same if `room` behind the first `base` items was a guess: a frame that wanted more is rendered again
/// with an eighth more than it needs. With `repeats`, for later frames of the same need, the room becomes
/// exactly that. Error for more than a list can hold.
void finishGuessed(PassContext& frame, const shader::BoundProgram& finish, const gpu::BufferRef& count,
                   std::uint64_t capacity, std::uint64_t base, std::uint64_t& room, bool repeats = false);
/// Error for a list of more fragments than shaders can number.
void requireListable(std::uint64_t fragments);

/// A number for every occupied voxel.
struct VoxelSlots {
  gpu::TextureRef numbers;   ///< d3 r32ui: of a voxel its slot from 1 on, or 0
  gpu::BufferRef count;      ///< as countBuffer()
  gpu::BufferRef voxels;     ///< a word a slot: its voxel, packed
  gpu::BufferRef fragments;  ///< a word a slot: fragments in it
  std::uint64_t room = 0;    ///< slots that there is room for
};

/// The technique's programs of the three files.
struct SlotPrograms {
  const shader::BoundProgram &claim, &number, &finish;
};

/// Slots for the voxels of a list. The pass keeps `room`, 0 at first: a guess, or the need of earlier frames.
VoxelSlots claimSlots(PassContext& frame, const VoxelFragments& list, const SlotPrograms& programs,
                      std::uint64_t& room);

/// An invocation for each slot, in groups of kCountedGroupSize; a barrier follows.
void forEachSlot(PassContext& frame, const shader::BoundProgram& program, const shader::BindingSet& bindings,
                 const VoxelSlots& slots);

}  // namespace lumivox
