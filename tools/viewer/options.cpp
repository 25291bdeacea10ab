#include "viewer/options.h"

#include "common/named_texts.h"
#include "lumivox/plugin/loader.h"

namespace lumivox::viewer {

void ViewOptions::addTo(CLI::App& app) {
  command::takesNames(app.add_option("SCENE", scene, "the scene's text or name")->required(),
                      command::NamedText::scene);
  command::takesNames(
      app.add_option("PIPELINE", pipelines,
                     "the pipelines' texts or names, the first shown (default: every committed "
                     "one that suits the scene)"),
      command::NamedText::pipeline);
  run.addTo(app);
  app.add_option("--window", windowSize, "WxH: size of the window (default: that of last time, or 1280x800)");
  app.add_option("--fps-limit", fpsLimit,
                 "most frames a second that the window draws (default 60; 0: no limit)")
      ->check(command::numberBetween(0.0, 10000.0));
  app.add_option("--script", script, "a text of what is done in the window, in order");
  app.add_option("--layout", layout,
                 "where sizes and the open panel are kept (default: lumivox/layout.view in "
                 "$XDG_STATE_HOME or ~/.local/state; with a script: nowhere)");
}

SessionOptions ViewOptions::session(const command::GlobalOptions& global) const {
  SessionOptions session;
  session.scene = scene;
  session.pipelines = pipelines;
  session.settings = run.settings;
  session.camera = run.camera;
  session.time = run.time;
  session.seed = run.seed;
  std::tie(session.width, session.height) = run.size();
  session.techniques = TechniqueSet::defaultDirectories(global.techniques);
  session.strict = global.strict;
  session.sceneLoad = global.sceneLoad();
  session.device = global.deviceOptions();
  return session;
}

}  // namespace lumivox::viewer
