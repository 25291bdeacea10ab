// The three things that vdbexport does: export, --list and --diff.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/command_line.h"
#include "common/display_options.h"

namespace lumivox::vdb {

struct Options {
  std::vector<std::filesystem::path> inputs;  ///< SCENE PIPELINE, or .vdb files
  std::filesystem::path output, preview;
  command::RunOptions run;
  command::DisplayOptions display;
  std::string frames;
  double framesPerSecond = 24.0;
  std::vector<std::string> grids, levels;
  bool all = false, half = false, list = false, diff = false, json = false;
  double tolerance = 0.0;

  void addTo(CLI::App& app);
};

int exportGrids(const Options& options, const command::GlobalOptions& global);
/// --list: the grids of a pipeline on a scene, of a pipeline alone (without sizes; nothing runs) or of a .vdb
/// file.
int list(const Options& options, const command::GlobalOptions& global);
int diff(const Options& options, const command::GlobalOptions& global);

}  // namespace lumivox::vdb
