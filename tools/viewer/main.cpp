// lumivox-view: a window in which techniques are looked at, judged and changed while they run. `lumivox view`
// starts it.
#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>

#include "common/command_line.h"
#include "common/manual.h"
#include "lumivox/base/error.h"
#include "lumivox/plugin/technique.h"
#include "viewer/session.h"
#include "viewer/window.h"

namespace {

using namespace lumivox;
using namespace lumivox::command;
using namespace lumivox::viewer;

struct ViewOptions {
  std::filesystem::path scene, script, layout;
  std::vector<std::filesystem::path> pipelines;
  RunOptions run;
  std::string windowSize;
  double fpsLimit = 60.0;
};

/// Where the layout of the window is kept for this user: $XDG_STATE_HOME/lumivox/layout.view, else in
/// ~/.local/state; nowhere without a home.
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
  SessionOptions session;
  session.scene = options.scene;
  session.pipelines = options.pipelines;
  session.settings = options.run.settings;
  session.camera = options.run.camera;
  session.time = options.run.time;
  std::tie(session.width, session.height) = options.run.size();
  session.techniques = TechniqueSet::defaultDirectories(global.techniques);
  session.sceneLoad = global.sceneLoad();
  session.device = global.deviceOptions();
  std::vector<Action> script;
  if (!options.script.empty()) script = readScript(options.script);
  WindowOptions window;
  window.restoresSize = options.windowSize.empty();
  if (!window.restoresSize) std::tie(window.width, window.height) = parseResolution(options.windowSize);
  window.fpsLimit = options.fpsLimit;
  window.layoutFile = options.layout;
  if (options.layout.empty() && options.script.empty()) window.layoutFile = layoutFile();
  window.title = fmt::format("{} - Lumivox", options.scene.filename().string());
  // The session first: texts that are wrong open no window. Its threads begin when the window asks for a
  // picture.
  Session looked(session, [] { Window::wake(); });
  {
    Window shown(window);
    shown.run(looked, std::move(script));
  }
  // A frame, an error or a compilation may take long: nobody waits for it any more.
  constexpr double kLongestEnd = 0.5;  // s
  if (!looked.stop(kLongestEnd)) {
    std::fflush(nullptr);
    std::_Exit(kGood);
  }
  return kGood;
}

int run(int count, char** arguments) {
  requireLibraryOf(techniqueVersionHere());
  CLI::App app{"Shows a scene in a window: techniques are looked at, judged and changed while they run."};
  app.name("lumivox-view");
  app.set_version_flag("--version", std::string("lumivox-view ") + LUMIVOX_VERSION);
  app.option_defaults()->always_capture_default(false);
  GlobalOptions global;
  global.commandLine = asTyped("lumivox view", count, arguments);
  global.addTo(app);
  ViewOptions options;
  app.add_option("SCENE", options.scene, "the scene's text")->required();
  app.add_option("PIPELINE", options.pipelines,
                 "the pipelines' texts, the first shown (default: every committed one that suits the scene)");
  options.run.addTo(app);
  app.add_option("--window", options.windowSize,
                 "WxH: size of the window (default: that of last time, or 1280x800)");
  app.add_option("--fps-limit", options.fpsLimit,
                 "most frames a second that the window draws (default 60; 0: no limit)")
      ->check(CLI::Range(0.0, 10000.0));
  app.add_option("--script", options.script, "a text of what is done in the window, in order");
  app.add_option("--layout", options.layout,
                 "where sizes and the open panel are kept (default: lumivox/layout.view in "
                 "$XDG_STATE_HOME or ~/.local/state; with a script: nowhere)");
  addDescriptionOptions(app, LUMIVOX_VERSION);
  if (const auto done = parseOptions(app, global, count, arguments)) return *done;
  return view(options, global);
}

}  // namespace

int main(int count, char** arguments) {
  return lumivox::command::guarded("lumivox-view", [=] { return run(count, arguments); });
}
