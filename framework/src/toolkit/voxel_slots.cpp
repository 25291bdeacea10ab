#include "lumivox/toolkit/voxel_slots.h"

#include <algorithm>

#include "lumivox/toolkit/bindings.h"
#include "toolkit_shaders.h"

namespace lumivox {

namespace {

namespace code = shaders::toolkit;

}  // namespace

VoxelSlots claimSlots(PassContext& frame, const VoxelFragments& list, std::uint64_t& room) {
  VoxelSlots slots;
  slots.numbers = frame.emptyVolume(list.grid.resolution, gpu::Format::r32ui, "slots of voxels");
  slots.count = countBuffer(frame, "slot count");
  slots.voxels = frame.elements(code::claim::slotVoxels, list.capacity, "voxels of slots");
  forEachFragment(frame, frame.program(code::claim::kProgram), {SlotBinding(slots)}, list);
  // First guess: surfaces fill about as many voxels as six sides of the grid, some in two layers, and at most
  // one for each fragment.
  const auto side = static_cast<std::uint64_t>(list.grid.longest());
  if (room == 0) room = std::min(8 * side * side, list.capacity);
  slots.room = room;
  finishGuessed(frame, slots.count, slots.room, 0, room);
  slots.fragments = frame.elements(code::number::fragmentsOfSlot, slots.room, "fragments of slots");
  forEachSlot(frame, frame.program(code::number::kProgram), {}, slots);
  return slots;
}

SlotBinding::SlotBinding(const VoxelSlots& slots)
    : BindingSet{shader::ImageSlot{"slots"}(slots.numbers), shader::StorageSlot{"SlotCount"}(slots.count),
                 shader::StorageSlot{"SlotVoxels"}(slots.voxels),
                 shader::StorageSlot{"FragmentsOfSlot"}(slots.fragments)} {}

void forEachSlot(PassContext& frame, const shader::BoundProgram& program, const shader::BindingSet& bindings,
                 const VoxelSlots& slots) {
  frame.dispatchIndirect(program, {bindings, SlotBinding(slots)}, *slots.count, kGroupsOffset);
}

}  // namespace lumivox
