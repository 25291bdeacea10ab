// Runs one cell of the matrix in this process.
#pragma once

#include <string>

#include "stress/bench.h"
#include "stress/protocol.h"

namespace lumivox::stress {

/// Everything known about a cell before it runs, which is all that remains if its worker dies.
StressCell cellBefore(const CellRequest& request, const std::string& family, TechniqueSource& techniques,
                      const std::vector<std::string>& repeatArguments);

/// Runs a cell and fills in the rest. An exception of the case becomes an outcome.
StressCell runCell(Ground& ground, const CellRequest& request,
                   const std::vector<std::string>& repeatArguments);

/// Fills in the names of the device.
void describeDevice(StressCell& cell, const WorkerDevice& device);

}  // namespace lumivox::stress
