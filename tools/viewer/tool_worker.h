// What other programs of Lumivox do with what is seen, in the background.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "viewer/latest_worker.h"

namespace lumivox::viewer {

struct ToolWish {
  std::string done;                              ///< what is said in the end
  std::vector<std::string> words;                ///< of the command line
  std::vector<std::filesystem::path> temporary;  ///< removed afterwards
};
struct ToolResult {
  std::string message;
  bool failed = false;
};
using ToolWorker = LatestWorker<ToolWish, ToolResult>;

/// Runs one program at a time, which ends with the worker.
ToolWorker::Work makeToolWork();

}  // namespace lumivox::viewer
