// Shares large items of work among many threads.
#pragma once

#include <array>
#include <cstdint>

#include "lumivox/pipeline/pass.h"

namespace lumivox::voxelization {

/// Items that a dispatch puts aside because they would keep one thread too long; the next dispatch shares
/// them among many threads. Shader side: shaders/voxelization/aside.glsl.
class Aside {
 public:
  /// Room for so many items.
  Aside(PassContext& frame, std::uint64_t mostItems)
      : buffer_(frame.buffer((kNothing.size() + mostItems) * sizeof(std::uint32_t), "items put aside")) {}

  /// Runs a program of `variant` on each of `items`, and then the one with MANY on those that it put aside.
  template <class Variant, class Constants>
  void dispatch(PassContext& frame, Variant variant, const Constants& constants,
                const shader::BindingSet& bindings, std::uint64_t items) const {
    const shader::BindingSet all{bindings, shader::StorageSlot{"Aside"}(buffer_)};
    buffer_->uploadValues(std::span<const std::uint32_t>(kNothing));
    frame.dispatchList(frame.program(variant, constants), all, items);
    variant.many = 1;
    frame.dispatchIndirect(frame.program(variant, constants), all, *buffer_);
  }

 private:
  static constexpr std::uint32_t kGroupsPerItem = 8;
  /// Work groups along x, y and z, then the number of items.
  static constexpr std::array<std::uint32_t, 4> kNothing{0, kGroupsPerItem, 1, 0};

  gpu::BufferRef buffer_;
};

}  // namespace lumivox::voxelization
