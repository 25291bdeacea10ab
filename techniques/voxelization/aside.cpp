#include "aside.h"

#include <array>

namespace lumivox::voxelization {
namespace {

constexpr std::uint32_t kGroupsPerItem = 8;
/// Work groups along x, y and z, then the number of items.
constexpr std::array<std::uint32_t, 4> kNothing{0, kGroupsPerItem, 1, 0};

}  // namespace

Aside::Aside(PassContext& frame, std::uint64_t mostItems)
    : buffer_(frame.buffer((kNothing.size() + mostItems) * sizeof(std::uint32_t), "items put aside")) {}

void Aside::clear() {
  buffer_->uploadValues(std::span<const std::uint32_t>(kNothing));
}

void Aside::workOff(PassContext& frame, const shader::BoundProgram& program,
                    const shader::BindingSet& bindings) const {
  frame.dispatchIndirect(program, bindings, *buffer_);
}

}  // namespace lumivox::voxelization
