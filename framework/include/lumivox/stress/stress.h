// The stress battery: every pipeline on every extreme case, in processes of their own, so that a crash or a
// hang costs one cell and not the battery. What the outcomes mean and how to repeat a cell: docs/stress.md.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "lumivox/report/store.h"

namespace lumivox {

/// A case as `lumivox stress --list` shows it.
struct StressCaseInfo {
  std::string family;  ///< stiff_transport, geometry, scale_and_place, light, picture_and_camera, time,
                       ///< refinement, repeatability, parameters
  std::string name;     ///< unique: "closed_box_albedo_0.999"
  std::string meaning;  ///< what is extreme about it and what is measured, one sentence
  bool quick = false;   ///< part of the quick battery
};
const std::vector<StressCaseInfo>& stressCases();

struct StressOptions {
  std::vector<std::filesystem::path> pipelines;  ///< empty: every committed one
  std::string technique;                         ///< only pipelines of this technique; empty: all
  std::vector<std::string> families, cases;      ///< empty: all
  bool quick = false;                            ///< only the quick cases, at small sizes
  double timeLimit = 0.0;                        ///< s for one cell; 0: 20 quick, 300 full
  std::filesystem::path output;                  ///< folder for the page and the pictures; empty: neither
  std::filesystem::path store;                   ///< results store; empty: none
  std::vector<std::string> program;              ///< that runs one worker: the words of its command line
  std::function<void(const StressCell& cell, std::size_t done, std::size_t total)> progress;
};

struct StressSummary {
  std::vector<StressCell> cells;
  std::filesystem::path page;  ///< empty: none was asked for
  /// No cell is broken: NaN, infinite, crashed or hung.
  bool sound() const;
};

}  // namespace lumivox
