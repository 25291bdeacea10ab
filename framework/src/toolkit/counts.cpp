#include "lumivox/toolkit/counts.h"

#include <fmt/format.h>

#include <algorithm>

#include "lumivox/base/error.h"
#include "toolkit_shaders.h"

namespace lumivox {

namespace {

namespace code = shaders::toolkit;

constexpr std::uint64_t kWantedOffset = 4 * sizeof(std::uint32_t);  // in the words of countBuffer()

}  // namespace

void requireListable(std::uint64_t fragments) {
  if (fragments > 0x7fffffffu) throw Error(fmt::format("{} fragments do not fit into one list", fragments));
}

gpu::BufferRef countBuffer(PassContext& frame, const char* label) {
  gpu::BufferRef count = frame.buffer(kWantedOffset + sizeof(std::uint32_t), label);
  count->clear();
  return count;
}

void finishCount(PassContext& frame, const gpu::BufferRef& count, std::uint64_t capacity, int itemsOfGroup) {
  frame.dispatch(
      frame.program(code::finish::kProgram),
      {code::finish::count(count), code::finish::finish({static_cast<std::int32_t>(capacity), itemsOfGroup})},
      {1, 1, 1});
}

void finishGuessed(PassContext& frame, const gpu::BufferRef& count, std::uint64_t capacity,
                   std::uint64_t base, std::uint64_t& room, bool repeats) {
  finishCount(frame, count, capacity);
  frame.checkAfterFrame(count, kWantedOffset, [=, &room](PassContext&, std::uint32_t wanted) {
    const bool fits = wanted <= capacity;
    if (fits && !repeats) return true;
    requireListable(wanted);
    const std::uint64_t needed = std::max<std::uint64_t>(wanted, base + 1) - base;
    room = repeats ? needed : needed + needed / 8;
    return fits;
  });
}

void scan(PassContext& frame, const gpu::BufferRef& numbers, std::uint64_t items, int columns,
          const gpu::BufferRef& totals) {
  frame.dispatch(frame.program(code::scan::Variant{.totals = totals != nullptr}),
                 {code::scan::scan({static_cast<std::uint32_t>(items), static_cast<std::uint32_t>(columns)}),
                  code::scan::numbers(numbers), code::scan::totals(totals)},
                 {1, 1, 1});
}

}  // namespace lumivox
