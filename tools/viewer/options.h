// The command line of the window's program. `lumivox view` parses the same options, so that both have the
// same help, completions and messages.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/command_line.h"
#include "viewer/session_options.h"

namespace lumivox::viewer {

/// The program's sentence in the help.
inline constexpr const char* kViewMeaning =
    "shows a scene in a window: techniques are looked at, judged and changed while they run";

struct ViewOptions {
  std::filesystem::path scene, script, layout;
  std::vector<std::filesystem::path> pipelines;
  command::RunOptions run;
  std::string windowSize;  ///< "WxH"; empty: the size of the last run
  double fpsLimit = 60.0;

  void addTo(CLI::App& app);
  /// The session's options. Error for an invalid value.
  SessionOptions session(const command::GlobalOptions& global) const;
};

}  // namespace lumivox::viewer
