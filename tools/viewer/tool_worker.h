// Runs other programs of Lumivox in the background, on the shown scene and pipeline.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "viewer/latest_worker.h"

namespace lumivox::viewer {

struct ToolWish {
  std::string done;                              ///< the message on success
  std::vector<std::string> words;                ///< of the command line
  std::vector<std::filesystem::path> temporary;  ///< removed afterwards
};
struct ToolResult {
  std::string message;
  bool failed = false;
};
using ToolWorker = LatestWorker<ToolWish, ToolResult>;

/// Runs one program at a time, and stops it when the worker ends.
ToolWorker::Work makeToolWork();

}  // namespace lumivox::viewer
