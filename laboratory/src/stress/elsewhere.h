// Frames rendered by another process.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "stress/bench.h"
#include "stress/protocol.h"

namespace lumivox::stress {

/// Error when there is no program to start, or when it gives no answer within a minute.
std::uint64_t askForContent(const Ground& ground, const ContentRequest& request,
                            const std::vector<std::string>& environment);

}  // namespace lumivox::stress
