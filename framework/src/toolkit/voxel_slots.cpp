#include "lumivox/toolkit/voxel_slots.h"

#include <fmt/format.h>

#include <algorithm>

#include "lumivox/base/error.h"
#include "lumivox/toolkit/bindings.h"

namespace lumivox {

namespace {

constexpr std::uint64_t kWantedOffset = 4 * sizeof(std::uint32_t);  // in the words of countBuffer()

/// Block FinishCount of common/finish_count.glsl.
struct alignas(16) FinishBlock {
  std::int32_t capacity = 0, workGroupSize = 0;
};

constexpr shader::StorageSlot kSlotVoxels{"SlotVoxels", shader::kByName, sizeof(std::uint32_t)},
    kFragmentsOfSlot{"FragmentsOfSlot", shader::kByName, sizeof(std::uint32_t)};

}  // namespace

void requireListable(std::uint64_t fragments) {
  if (fragments > 0x7fffffffu) throw Error(fmt::format("{} fragments do not fit into one list", fragments));
}

gpu::BufferRef countBuffer(PassContext& frame, const char* label) {
  gpu::BufferRef count = frame.buffer(kWantedOffset + sizeof(std::uint32_t), label);
  count->clear();
  return count;
}

void finishCount(PassContext& frame, const shader::BoundProgram& finish, const gpu::BufferRef& count,
                 std::uint64_t capacity, int itemsOfGroup) {
  frame.dispatch(
      finish,
      {shader::StorageSlot{"Count"}(count),
       shader::UniformSlot<FinishBlock>{"FinishCount"}({static_cast<std::int32_t>(capacity), itemsOfGroup})},
      {1, 1, 1});
}

void finishGuessed(PassContext& frame, const shader::BoundProgram& finish, const gpu::BufferRef& count,
                   std::uint64_t capacity, std::uint64_t base, std::uint64_t& room, bool repeats) {
  finishCount(frame, finish, count, capacity);
  frame.checkAfterFrame(count, kWantedOffset, [=, &room](PassContext&, std::uint32_t wanted) {
    const bool fits = wanted <= capacity;
    if (fits && !repeats) return true;
    requireListable(wanted);
    const std::uint64_t needed = std::max<std::uint64_t>(wanted, base + 1) - base;
    room = repeats ? needed : needed + needed / 8;
    return fits;
  });
}

VoxelSlots claimSlots(PassContext& frame, const VoxelFragments& list, const SlotPrograms& programs,
                      std::uint64_t& room) {
  VoxelSlots slots;
  slots.numbers = frame.emptyVolume(list.grid.resolution, gpu::Format::r32ui, "slots of voxels");
  slots.count = countBuffer(frame, "slot count");
  slots.voxels = frame.elements(kSlotVoxels, list.capacity, "voxels of slots");
  const shader::BindingSet claimed{kSlotVoxels(slots.voxels), shader::StorageSlot{"SlotCount"}(slots.count),
                                   shader::ImageSlot{"slots"}(slots.numbers)};
  forEachFragment(frame, programs.claim, claimed, list);
  // A first guess: surfaces fill about as many voxels as six sides of the grid, some in two layers; never
  // more than there are fragments.
  const auto side = static_cast<std::uint64_t>(list.grid.longest());
  if (room == 0) room = std::min(8 * side * side, list.capacity);
  slots.room = room;
  finishGuessed(frame, programs.finish, slots.count, slots.room, 0, room);
  slots.fragments = frame.elements(kFragmentsOfSlot, slots.room, "fragments of slots");
  forEachSlot(frame, programs.number, {claimed, kFragmentsOfSlot(slots.fragments)}, slots);
  return slots;
}

void forEachSlot(PassContext& frame, const shader::BoundProgram& program, const shader::BindingSet& bindings,
                 const VoxelSlots& slots) {
  frame.dispatchIndirect(program, bindings, *slots.count, kGroupsOffset);
}

}  // namespace lumivox
