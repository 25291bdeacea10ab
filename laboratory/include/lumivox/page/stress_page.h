// The page "Where each technique breaks".
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lumivox/results/stress_cells.h"

namespace lumivox {

/// Writes `folder`/index.html and index.json; the images are there already. Returns the page. A cell whose
/// image is not there has no link.
std::filesystem::path writeStressPage(const std::filesystem::path& folder,
                                      const std::vector<StressCell>& cells, const std::string& commandLine);

}  // namespace lumivox
