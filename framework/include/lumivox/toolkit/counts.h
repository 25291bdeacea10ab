// Numbers that the device finds, and walks over as many items without a word to the host.
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

/// Turns a number of items into the arguments of a dispatch over them, so many to a group. What there is no
/// room for is cut off, and can be told from the number that was wanted.
void finishCount(PassContext& frame, const gpu::BufferRef& count, std::uint64_t capacity,
                 int itemsOfGroup = kCountedGroupSize);
/// The same where `room` behind the first `base` items was a guess: a frame that wanted more is rendered
/// again with an eighth more than it needs. With `repeats`, where later frames will need as much as this one,
/// the room becomes as much as that. Error for more than a list can hold.
void finishGuessed(PassContext& frame, const gpu::BufferRef& count, std::uint64_t capacity,
                   std::uint64_t base, std::uint64_t& room, bool repeats = false);
/// Error for a list of more fragments than shaders can number.
void requireListable(std::uint64_t fragments);

/// In place of numbers the sums of those before each, exclusive. An item has a word in each of `columns`,
/// which lie beside each other; each column is summed by itself. The first words of `totals`, if there is
/// one, become the sums of all items.
void scan(PassContext& frame, const gpu::BufferRef& numbers, std::uint64_t items, int columns = 1,
          const gpu::BufferRef& totals = nullptr);

}  // namespace lumivox
