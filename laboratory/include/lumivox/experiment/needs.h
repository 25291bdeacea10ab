// The parts of pipelines that scenes needed: each pipeline on each scene, pruned and unpruned.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "lumivox/experiment/report.h"

namespace lumivox {

/// One pipeline on one scene.
struct NeededCell {
  std::string scene, pipeline;  ///< files as a person would type them here
  std::string unsuited;  ///< what the scene lacks for all that the pipeline adds to direct light; or empty
  std::string absent;    ///< why there is no record; empty when there is
  bool failed = false;   ///< there is none because the pipeline failed, not for want of a model
  std::optional<PruningRecord> record;
};

/// Every pipeline of `options` (none: every committed one) on every scene of it, scene by scene, at the
/// default parameters with `settings`. With `repeats` 0 nothing is timed, which is much faster. A scene that
/// cannot be loaded for want of a model, and a pipeline that fails on a scene, say so in their cells. `done`
/// is called after each cell. Error for a wrong text.
std::vector<NeededCell> measureNeeded(
    gpu::Device& device, TechniqueSet& techniques, const ReportOptions& options,
    const std::function<Scene(const std::filesystem::path&)>& loadScene,
    const std::function<void(std::size_t done, std::size_t total)>& done = {});

}  // namespace lumivox
