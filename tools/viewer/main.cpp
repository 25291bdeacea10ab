// lumivox-view: a window to look at techniques, judge and change them while they run. `lumivox view` starts
// it.
#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>

#include "common/command_line.h"
#include "common/manual.h"
#include "lumivox/base/error.h"
#include "lumivox/plugin/technique.h"
#include "viewer/ending_signals.h"
#include "viewer/options.h"
#include "viewer/window.h"

namespace {

using namespace lumivox;
using namespace lumivox::command;
using namespace lumivox::viewer;

/// The file of this user's window layout: $XDG_STATE_HOME/lumivox/layout.view, else in ~/.local/state. Empty
/// without a home folder.
std::filesystem::path layoutFile() {
  const auto folderOf = [](const char* variable) {
    const char* value = std::getenv(variable);
    return value == nullptr ? std::filesystem::path() : std::filesystem::path(value);
  };
  std::filesystem::path folder = folderOf("XDG_STATE_HOME");
  if (folder.empty() && !folderOf("HOME").empty()) folder = folderOf("HOME") / ".local" / "state";
  return folder.empty() ? folder : folder / "lumivox" / "layout.view";
}

int view(const ViewOptions& options, const GlobalOptions& global) {
  const SessionOptions session = options.session(global);
  std::vector<Action> script;
  if (!options.script.empty()) script = readScript(options.script);
  WindowOptions window;
  window.restoresSize = options.windowSize.empty();
  if (!window.restoresSize)
    std::tie(window.width, window.height) = parseResolution(options.windowSize, "--window");
  window.fpsLimit = options.fpsLimit;
  window.layoutFile = options.layout;
  if (options.layout.empty() && options.script.empty()) window.layoutFile = layoutFile();
  window.title = fmt::format("{} - Lumivox", options.scene.filename().string());
  // The session comes first, so that no window opens for wrong texts. Its threads start when the window asks
  // for a picture.
  auto looked = std::make_unique<Session>(session, [] { Window::wake(); });
  // Signals that end the program close the window, so that temporary files are removed.
  const EndingSignals signals;
  window.ends = EndingSignals::came;
  {
    Window shown(window);
    shown.run(*looked, std::move(script));
  }
  // A frame, an error or a compilation may take long; the program does not wait for its end.
  constexpr double kLongestEnd = 0.5;  // s
  const bool stopped = looked->stop(kLongestEnd);
  if (stopped) looked.reset();
  std::fflush(nullptr);
  EndingSignals::endByIt();
  if (!stopped) std::_Exit(kGood);
  return kGood;
}

int run(int count, char** arguments) {
  requireLibraryOf(techniqueVersionHere());
  CLI::App app{kViewMeaning};
  app.name("lumivox-view");
  app.set_version_flag("--version", std::string("lumivox-view ") + LUMIVOX_VERSION);
  app.option_defaults()->always_capture_default(false);
  GlobalOptions global;
  global.commandLine = asTyped("lumivox view", count, arguments);
  global.addTo(app);
  ViewOptions options;
  options.addTo(app);
  addDescriptionOptions(app, LUMIVOX_VERSION);
  if (const auto done = parseOptions(app, global, count, arguments)) return *done;
  return view(options, global);
}

}  // namespace

int main(int count, char** arguments) {
  return lumivox::command::guarded("lumivox-view", [=] { return run(count, arguments); });
}
