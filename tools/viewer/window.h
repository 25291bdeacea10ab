// The window: GLFW and Dear ImGui. It draws the session's picture and panels, and converts input to the
// statements of scripts.
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
  /// The file of this user's layout, a text of statements; empty: the layout is not stored.
  std::filesystem::path layoutFile;
  bool restoresSize = true;  ///< from the layout; else width and height
  std::string title = "Lumivox";
  std::function<bool()> ends;  ///< polled: whether to close; empty: never
};

class Window {
 public:
  /// Opens the window: at most one per process, on the main thread. AbsentError if there is no display or no
  /// OpenGL 4.5.
  explicit Window(const WindowOptions& options);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// Wakes run(). May be called from any thread.
  static void wake();
  /// Runs until the user or a statement of the script closes the window. Error, with its place, if a
  /// statement of the script fails.
  void run(Session& session, std::vector<Action> script);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lumivox::viewer
