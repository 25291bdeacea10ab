// libFuzzer's door to one entry, which the build chooses by the name of its folder of seeds.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "fuzz/entries.h"

namespace {

const lumivox::fuzz::Entry& entry() {
  const auto& all = lumivox::fuzz::entries();
  const auto found = std::find_if(all.begin(), all.end(), [](const lumivox::fuzz::Entry& one) {
    return std::string_view(one.name) == LUMIVOX_FUZZ_ENTRY;
  });
  if (found == all.end()) {
    std::fprintf(stderr, "tests/fuzz/seeds/%s: entries.cpp has no entry of this name\n", LUMIVOX_FUZZ_ENTRY);
    std::abort();
  }
  return *found;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const lumivox::fuzz::Entry& door = entry();
  door.run({reinterpret_cast<const char*>(data), size});
  return 0;
}
