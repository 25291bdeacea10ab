// The window: GLFW and Dear ImGui. It draws the session's picture and panels, and turns what hands do into
// the statements of scripts.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "viewer/session.h"

namespace lumivox::viewer {

struct WindowOptions {
  int width = 1280, height = 800;
  double fpsLimit = 60.0;
  /// Where the layout of this user is kept, a text of statements; empty: nowhere.
  std::filesystem::path layoutFile;
  bool restoresSize = true;  ///< that of the layout; else width and height
  std::string title = "Lumivox";
  std::function<bool()> ends;  ///< asked again and again: whether to close; empty: never
};

class Window {
 public:
  /// Opens it. AbsentError when there is no display or no OpenGL 4.5. It must be the process's only one, on
  /// the main thread.
  explicit Window(const WindowOptions& options);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// Wakes run() up, from any thread.
  static void wake();
  /// Until it is closed, or the script's statements are done and one of them closes it. Error: a statement of
  /// the script went wrong; it names its place.
  void run(Session& session, std::vector<Action> script);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lumivox::viewer
