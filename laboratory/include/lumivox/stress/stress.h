// The stress battery: every pipeline on every extreme case, in processes of their own, so that a crash or a
// hang costs one cell and not the battery. What the outcomes mean and how to repeat a cell: docs/stress.md.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "lumivox/experiment/shard.h"
#include "lumivox/gpu/device.h"
#include "lumivox/results/store.h"

namespace lumivox {

/// A case as `lumivox stress --list` shows it.
struct StressCaseInfo {
  std::string family;   ///< stiff_transport, geometry, scale_and_place, light, image_and_camera, time,
                        ///< refinement, repeatability, parameters
  std::string name;     ///< unique: "closed_box_albedo_0.999"
  std::string meaning;  ///< what is extreme about it and what is measured, one sentence
  bool quick = false;   ///< part of the quick battery
};

/// One case on one pipeline, not yet run.
struct StressJob {
  StressCaseInfo info;
  std::filesystem::path pipeline;
  std::string technique;  ///< that the pipeline represents
};

struct StressOptions {
  std::vector<std::filesystem::path> pipelines;  ///< empty: every committed one, voxelizers too
  std::string technique;                         ///< only pipelines of this technique; empty: all
  std::vector<std::string> families, cases;      ///< empty: all; cases may end in '*'
  bool quick = false;                            ///< only the quick cases, at small sizes
  double timeLimit = 0.0;                        ///< s for one cell; 0: 60 quick, 600 full
  /// 0: one a processor where the device is a software rasteriser, else one, since several would share the
  /// device's memory and its watchdog.
  int workers = 0;
  /// Most memory of textures and buffers, which several workers share; 0: what the device has.
  std::uint64_t memoryBytes = 0;
  std::filesystem::path output;  ///< folder for the page and the images; empty: neither
  std::filesystem::path store;   ///< results store; empty: none
  /// Run this share of the plan alone: successive cells of it, or what `points` says; cells that the store
  /// holds are not run again.
  Shard shard = {};
  std::filesystem::path points;  ///< a SharedPlan (experiment/shard.h) of the same battery; empty: none
  /// The store that shares are merged into: cells that it holds, or that another share has claimed there, are
  /// left out. Empty: none.
  std::filesystem::path into;
  /// That runs one worker: the words of its command line, which ends up in serveStress(). Among several,
  /// `--worker-memory BYTES` follows them.
  std::vector<std::string> program;
  std::vector<std::string>
      repeatArguments;      ///< further options that a repeating command needs, e.g. --device
  std::string commandLine;  ///< as typed, for the page
  std::function<void(const StressCell& cell, std::size_t done, std::size_t total, double secondsLeft)>
      progress;
};

/// The jobs of a battery, pipeline by pipeline. Error for an unknown family, case or technique, and for a
/// wrong pipeline text.
std::vector<StressJob> plannedStress(const StressOptions& options, TechniqueSource& techniques);

/// The shares of the cells that options.into does not hold, whatever machine ran them there, as planSweep().
SharedPlan planStress(const StressOptions& options, TechniqueSource& techniques, std::size_t tasks,
                      double taskSeconds);

struct StressSummary {
  std::vector<StressCell> cells;  ///< in the order of the plan, without those left out
  std::size_t leftOut = 0;        ///< of a share: held already, or left to other shares
  std::filesystem::path page;     ///< empty: none was asked for
  /// No cell is broken: NaN, infinite, crashed or hung.
  bool sound() const;
};
/// A cell is in the store as soon as it was run. A worker that is lost is one broken cell.
StressSummary runStress(const StressOptions& options, TechniqueSource& techniques);

/// The device and options of a worker.
struct StressWorker {
  gpu::DeviceOptions device;
  SceneLoadOptions sceneLoad;
  std::vector<std::string> program;  ///< its own command line, for cells that need another process
  std::vector<std::string> repeatArguments;
};
/// A worker's life: reads one request a line from standard input, writes one answer a line to standard
/// output, until the input ends. What anything else prints goes to standard error.
void serveStress(const StressWorker& worker, TechniqueSource& techniques);

/// The technique that a pipeline represents: the one whose name its file's stem begins with (the longest);
/// else that of the last pass, for a pipeline without outputs; else that of the pass behind its first output
/// other than direct light, or behind its first output.
std::string techniqueOf(const Pipeline& pipeline, TechniqueSource& techniques);

}  // namespace lumivox
