// Checks that memory on the device suffices, with an error that says what would fit.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "lumivox/pipeline/pass.h"

namespace lumivox {

/// Allocates so many bytes, in as many buffers as they need, and frees them at once. Returns why it failed;
/// empty on success.
std::string whyNoRoom(PassContext& frame, std::uint64_t bytes);

/// Error, before any allocation, if `items` of something do not fit: it says how many bytes they need, and
/// the largest number, by repeated halving, that fits. `bytesOf`: bytes of each buffer or texture for so many
/// items; `what`: in the plural.
void requireRoom(PassContext& frame, int items, const std::function<std::vector<std::uint64_t>(int)>& bytesOf,
                 const std::string& what);

}  // namespace lumivox
