// Room for what is summed up over the fragments of each voxel, for the occupied ones alone.
#pragma once

#include <cstdint>

#include "lumivox/toolkit/counts.h"

namespace lumivox {

/// A number for every occupied voxel.
struct VoxelSlots {
  gpu::TextureRef numbers;   ///< d3 r32ui: of a voxel its slot from 1 on, or 0
  gpu::BufferRef count;      ///< as countBuffer()
  gpu::BufferRef voxels;     ///< a word a slot: its voxel, packed
  gpu::BufferRef fragments;  ///< a word a slot: fragments in it
  std::uint64_t room = 0;    ///< slots that there is room for
};

/// Slots for the voxels of a list. `room`, 0 at first, stays with the pass: a guess, or what earlier frames
/// needed.
VoxelSlots claimSlots(PassContext& frame, const VoxelFragments& list, std::uint64_t& room);

/// Slots for shaders that look up those of fragments' voxels (shaders/toolkit/slot_of_voxel.glsl).
class SlotBinding : public shader::BindingSet {
 public:
  explicit SlotBinding(const VoxelSlots& slots);
};

/// An invocation for each slot, in groups of kCountedGroupSize, and the slots besides
/// (shaders/toolkit/slots.glsl); a barrier follows.
void forEachSlot(PassContext& frame, const shader::BoundProgram& program, const shader::BindingSet& bindings,
                 const VoxelSlots& slots);

}  // namespace lumivox
