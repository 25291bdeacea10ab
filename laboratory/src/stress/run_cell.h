// One cell of the matrix, in this process.
#pragma once

#include <string>

#include "stress/bench.h"
#include "stress/protocol.h"

namespace lumivox::stress {

/// Everything about a cell that is known before it runs: also what a cell says whose worker died.
StressCell cellBefore(const CellRequest& request, const std::string& family, TechniqueSource& techniques,
                      const std::vector<std::string>& repeatArguments);

/// Runs it and fills in the rest. Whatever the case throws becomes an outcome.
StressCell runCell(Ground& ground, const CellRequest& request,
                   const std::vector<std::string>& repeatArguments);

/// Fills in the names of the device.
void describeDevice(StressCell& cell, const WorkerDevice& device);

}  // namespace lumivox::stress
