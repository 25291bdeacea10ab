// What the window's program takes on its command line. `lumivox view` reads the same list, so that its help,
// its completions and what it says of a wrong word are those of the window.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/command_line.h"
#include "viewer/session_options.h"

namespace lumivox::viewer {

/// In one sentence, for help.
inline constexpr const char* kViewMeaning =
    "shows a scene in a window: techniques are looked at, judged and changed while they run";

struct ViewOptions {
  std::filesystem::path scene, script, layout;
  std::vector<std::filesystem::path> pipelines;
  command::RunOptions run;
  std::string windowSize;  ///< "WxH"; empty: that of last time
  double fpsLimit = 60.0;

  void addTo(CLI::App& app);
  /// Error when a value says nothing that can be done.
  SessionOptions session(const command::GlobalOptions& global) const;
};

}  // namespace lumivox::viewer
