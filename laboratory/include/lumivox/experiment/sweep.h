// Measures many points into a results store, so that a later run measures only missing ones.
#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "lumivox/experiment/report.h"
#include "lumivox/results/store.h"

namespace lumivox {

struct SweepOptions {
  ReportOptions measure;  ///< what a report measures; neither `output` nor the budget is used
  /// Texts of their own that name scenes, pipelines, parameters and seeds; with them the scenes above may be
  /// none. Settings pin their axes too.
  std::vector<std::filesystem::path> texts;
  bool retryFailed = false;  ///< measure points anew that the store holds as failed
  bool planOnly = false;     ///< say what would be measured, and measure nothing
};

struct SweepSummary {
  std::vector<StoredRun> runs;         ///< every point of the plan that the store holds now, in order
  std::vector<std::string> keys;       ///< of every point of the plan
  std::size_t measured = 0, held = 0;  ///< points measured now; points that the store held already
  std::size_t failed = 0;              ///< of those measured now
  std::vector<std::string> missing;    ///< what planOnly would have measured: "cornell, x: cones=6"
  std::vector<std::string> unsuited;   ///< "scene, pipeline: why"
  std::vector<std::string> notes;      ///< which pipeline goes without which axis of a text
};

/// Measures every pipeline at every point of its sweeps on every scene, and what the texts name, but for what
/// the store holds. Each seed of a sweep's axis is a run of its own with that seed alone.
/// Errors, images and work of a point are stored as soon as they are measured, its times with those of its
/// batch: an interruption loses the point at work and the times of the batch.
/// Errors are measured apart from times; the timed frames of a batch take turns, and the first batch is timed
/// again at the end, which gives the floor below which differences of times say nothing (TimeFloor). Several
/// processes may sweep into one store: each leaves the points to the others that they are at, and while one
/// takes times on a machine the others of that user wait. Throws as makeReport.
SweepSummary runSweep(gpu::Device& device, TechniqueSet& techniques, const SweepOptions& options,
                      ResultsStore& store,
                      const std::function<Scene(const std::filesystem::path&)>& loadScene);

}  // namespace lumivox
