// Room on the device, or in words what would fit.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "lumivox/pipeline/pass.h"

namespace lumivox {

/// Why so many bytes cannot be had, in as many buffers as they need; empty where they can. They are given
/// back at once.
std::string whyNoRoom(PassContext& frame, std::uint64_t bytes);

/// Error where `items` of something do not fit, before anything of it is taken: it says how many bytes they
/// need, and of numbers halved from theirs the largest that fits. `bytesOf`: of each buffer or texture that
/// so many items take; `what`: in the plural.
void requireRoom(PassContext& frame, int items, const std::function<std::vector<std::uint64_t>(int)>& bytesOf,
                 const std::string& what);

}  // namespace lumivox
