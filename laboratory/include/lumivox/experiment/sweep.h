// Measures many points into a results store, so that a later run measures only missing ones.
#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "lumivox/experiment/report.h"
#include "lumivox/experiment/shard.h"
#include "lumivox/results/store.h"

namespace lumivox {

struct SweepOptions {
  ReportOptions measure;  ///< what a report measures; neither `output` nor the budget is used
  /// Texts of their own that name scenes, pipelines, parameters and seeds; with them the scenes above may be
  /// none. Settings pin their axes too.
  std::vector<std::filesystem::path> texts;
  bool retryFailed = false;  ///< measure points anew that the store holds as failed
  bool planOnly = false;     ///< say what would be measured, and measure nothing
  /// Measure this share of the plan alone: successive points of it, or what `points` says.
  Shard shard = {};
  std::filesystem::path points;  ///< a SharedPlan (experiment/shard.h) of the same sweep; empty: none
  /// The store that the shares are merged into: what it holds is not measured again, and what shares claim in
  /// it is left to them. Empty: none.
  std::filesystem::path into;
  bool forReport = false;  ///< the points of a report, with their images, in place of those of a sweep
};

struct SweepSummary {
  std::vector<StoredRun> runs;         ///< every point of the plan that the store holds now, in order
  std::vector<std::string> keys;       ///< of every point of the plan
  std::size_t measured = 0, held = 0;  ///< points measured now; points that the store held already
  std::size_t failed = 0;              ///< of those measured now
  std::size_t leftToOthers = 0;        ///< of those held, in stores of other shares
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

/// The shares of the points that options.into does not hold, whatever machine measured them there, of about
/// the same expected time by what it holds: `tasks` of them, or, with 0, as many as make each take about
/// `taskSeconds`; without a time known, kTasksUnknown. Never more than points, or than kMostTasks.
SharedPlan planSweep(gpu::Device& device, TechniqueSet& techniques, const SweepOptions& options,
                     const std::function<Scene(const std::filesystem::path&)>& loadScene, std::size_t tasks,
                     double taskSeconds);

/// Whether a store holds results of another version of Lumivox, or of these techniques, than is here.
bool holdsOtherVersions(const ResultsStore& store, TechniqueSource& techniques);

}  // namespace lumivox
