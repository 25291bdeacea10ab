// Messages between the battery and its workers: one JSON object a line.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "lumivox/gpu/device.h"
#include "stress/cases.h"

namespace lumivox::stress {

/// The first message of a worker, when its device is open, before anything is asked.
struct WorkerDevice {
  std::string device, driver, shaderInput;  ///< as in StressCell
  bool software = false;                    ///< rasterises on the processors
};
WorkerDevice workerDeviceOf(const gpu::Device& device);
std::string lineOf(const WorkerDevice& ready);
/// Nullopt for a line that says anything else.
std::optional<WorkerDevice> readyFrom(const std::string& line);

/// One cell to be run.
struct CellRequest {
  std::filesystem::path pipeline;
  std::string name;  ///< of the case
  bool quick = false;
  std::filesystem::path image;  ///< where to; empty: nowhere
};
/// The content of a frame: Bench::contentOf() for another process.
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
/// Error for a line that is none.
AnyRequest requestOf(const std::string& line);

}  // namespace lumivox::stress
