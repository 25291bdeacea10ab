// libFuzzer's door to one entry, which the build chooses.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "fuzz/entries.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  lumivox::fuzz::LUMIVOX_FUZZ_ENTRY({reinterpret_cast<const char*>(data), size});
  return 0;
}
