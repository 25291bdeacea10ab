// Renders frames in another process.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "stress/bench.h"
#include "stress/protocol.h"

namespace lumivox::stress {

/// Throws without a program to start, or without an answer within a minute.
std::uint64_t askForContent(const Ground& ground, const ContentRequest& request,
                            const std::vector<std::string>& environment);

}  // namespace lumivox::stress
