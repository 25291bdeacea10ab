// Messages between the battery and its workers: one JSON object per line.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "lumivox/gpu/device.h"
#include "stress/cases.h"

namespace lumivox::stress {

/// A worker's first message, sent once its device is open.
struct WorkerDevice {
  std::string device, driver, shaderInput;  ///< as in StressCell
  bool software = false;                    ///< whether it rasterises on the processors
};
WorkerDevice workerDeviceOf(const gpu::Device& device);
std::string lineOf(const WorkerDevice& ready);
/// Nullopt for any other line.
std::optional<WorkerDevice> readyFrom(const std::string& line);

/// One cell to be run.
struct CellRequest {
  std::filesystem::path pipeline;
  std::string name;  ///< of the case
  bool quick = false;
  std::filesystem::path image;  ///< where to write it; empty: nowhere
};
/// A request for the content of a frame: Bench::contentOf() for another process.
struct ContentRequest {
  std::filesystem::path pipeline;
  std::string committedScene;
  bool quick = false;
  Shot shot;
};

std::string lineOf(const CellRequest& request);
std::string lineOf(const ContentRequest& request);
/// Exactly one of the two.
struct AnyRequest {
  std::optional<CellRequest> cell;
  std::optional<ContentRequest> content;
};
/// Error for a line that is not a request.
AnyRequest requestOf(const std::string& line);

}  // namespace lumivox::stress
