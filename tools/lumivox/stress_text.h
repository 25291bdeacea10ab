// The stress battery's matrix for the terminal.
#pragma once

#include <string>
#include <vector>

#include "lumivox/results/store.h"

namespace lumivox::command {

/// Cases against pipelines, then every cell that is not stable with its number, reason and command.
std::string stressTable(const std::vector<StressCell>& cells);

}  // namespace lumivox::command
