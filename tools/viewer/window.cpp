#include "viewer/window.h"

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/log.h"
#include "viewer/window_state.h"

namespace lumivox::viewer {
namespace {

using Clock = std::chrono::steady_clock;

constexpr float kLetterPixels = 13.0f;  // at a scale of 1, as the font was drawn
constexpr float kSmallestScale = 0.25f, kLargestScale = 8.0f;
constexpr double kLongestStep = 0.1;     // s, the most that movement advances in one frame
constexpr double kWatchInterval = 0.25;  // s between checks of the files while the window is idle

std::string& lastGlfwError() {
  static std::string text;
  return text;
}

}  // namespace

Window::Window(const WindowOptions& options) : state_(std::make_unique<State>()) {
  State& s = *state_;
  s.options = options;
  glfwSetErrorCallback([](int, const char* text) { lastGlfwError() = text; });
  if (!glfwInit())
    throw AbsentError(
        fmt::format("there is no display to open a window on ({}); `lumivox render` makes images without one",
                    lastGlfwError()));
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
  s.window = glfwCreateWindow(options.width, options.height, options.title.c_str(), nullptr, nullptr);
  if (s.window == nullptr) {
    const std::string why = lastGlfwError();
    glfwTerminate();
    throw AbsentError(
        fmt::format("no window with OpenGL 4.5 ({}); `lumivox render` makes images without one", why));
  }
  s.listen();
  glfwMakeContextCurrent(s.window);
  glfwSwapInterval(1);
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = nullptr;  // readLayout() and writeLayout() store the layout instead
  io.ConfigFlags |= ImGuiConfigFlags_NavEnableKeyboard;
  ImGui_ImplGlfw_InitForOpenGL(s.window, true);
  ImGui_ImplOpenGL3_Init("#version 450 core");
  float scale = 1.0f, scaleY = 1.0f;
  glfwGetWindowContentScale(s.window, &scale, &scaleY);
  s.rescale(scale);
  // Called for another monitor, or another density of the same one.
  glfwSetWindowContentScaleCallback(s.window, [](GLFWwindow* window, float x, float) {
    static_cast<State*>(glfwGetWindowUserPointer(window))->rescale(x);
  });
  glfwSetWindowIconifyCallback(s.window, [](GLFWwindow* window, int away) {
    static_cast<State*>(glfwGetWindowUserPointer(window))->minimised = away != GLFW_FALSE;
  });
  s.texture = std::make_unique<ScreenTexture>();
}

Window::~Window() {
  state_->texture.reset();
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
  glfwDestroyWindow(state_->window);
  glfwTerminate();
}

/// Sets `touched` on every event of input or display. Call it before ImGui installs its callbacks, which call
/// these.
void Window::State::listen() {
  glfwSetWindowUserPointer(window, this);
  static const auto touch = [](GLFWwindow* of) {
    static_cast<State*>(glfwGetWindowUserPointer(of))->touched = true;
  };
  glfwSetCursorPosCallback(window, [](GLFWwindow* of, double, double) { touch(of); });
  glfwSetCursorEnterCallback(window, [](GLFWwindow* of, int) { touch(of); });
  glfwSetMouseButtonCallback(window, [](GLFWwindow* of, int, int, int) { touch(of); });
  glfwSetScrollCallback(window, [](GLFWwindow* of, double, double) { touch(of); });
  glfwSetKeyCallback(window, [](GLFWwindow* of, int, int, int, int) { touch(of); });
  glfwSetCharCallback(window, [](GLFWwindow* of, unsigned) { touch(of); });
  glfwSetWindowFocusCallback(window, [](GLFWwindow* of, int) { touch(of); });
  glfwSetWindowRefreshCallback(window, [](GLFWwindow* of) { touch(of); });
  glfwSetWindowSizeCallback(window, [](GLFWwindow* of, int, int) { touch(of); });
  glfwSetFramebufferSizeCallback(window, [](GLFWwindow* of, int, int) { touch(of); });
}

void Window::State::rescale(float to) {
  scale = std::clamp(to, kSmallestScale, kLargestScale);
  // Whole pixels keep the letters sharp.
  ImFontConfig font;
  font.SizePixels = std::round(kLetterPixels * scale);
  ImGuiIO& io = ImGui::GetIO();
  io.Fonts->Clear();
  io.Fonts->AddFontDefault(&font);
  ImGui_ImplOpenGL3_DestroyFontsTexture();
  ImGui_ImplOpenGL3_CreateFontsTexture();
  ImGui::GetStyle() = ImGuiStyle();
  ImGui::StyleColorsDark();
  ImGui::GetStyle().ScaleAllSizes(scale);
  soon = 4;
}

void Window::State::minimise(bool away) {
  if (away)
    glfwIconifyWindow(window);
  else
    glfwRestoreWindow(window);
  minimised = away;  // without a window manager no event would set it
  soon = 4;
}

std::string Window::State::layoutText() const {
  int width = 0, height = 0;
  glfwGetWindowSize(window, &width, &height);
  return dsl::format(dsl::parse(
      fmt::format("view \"layout\" {{\nwindow {} {}\npanels {}\npanel_width {:.0f}\npanel {}\n}}\n", width,
                  height, showsPanels ? "on" : "off", panelWidth, openPanel),
      "layout"));
}

void Window::State::readLayout() {
  std::error_code none;
  if (options.layoutFile.empty() || !std::filesystem::exists(options.layoutFile, none)) return;
  static const std::set<std::string> known{"window", "panels", "panel_width", "panel"};
  try {
    panels = panelsOf(*session);
    for (const Action& action : readScript(options.layoutFile)) {
      if (known.count(action.word()) == 0)
        throw Error(fmt::format("{}: expected window, panels, panel_width or panel", action.place().text()));
      if (action.word() != "window" || options.restoresSize) doInWindow(action);
    }
    layout = layoutText();
  } catch (const std::exception& error) {
    session->say(fmt::format("the layout of last time was not taken: {}", error.what()), true);
  }
}

void Window::State::writeLayout() {
  if (options.layoutFile.empty() || minimised) return;
  const std::string text = layoutText();
  if (text == layout) return;
  try {
    createParentDirectories(options.layoutFile);
    writeFileAtomically(options.layoutFile, text);
    layout = text;
  } catch (const std::exception& error) {
    logWarning("the layout of the window is not kept: {}", error.what());
  }
}

void Window::State::drawFrame(double seconds) {
  int width = 0, height = 0;
  glfwGetFramebufferSize(window, &width, &height);
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  feedClick();
  feedPress();
  ImGui::NewFrame();
  const ImGuiIO& io = ImGui::GetIO();
  if (!io.WantTextInput && session->question().empty()) {
    walk(seconds);
    look(seconds);
    for (const KeyStatement& one : keyStatements())
      // With keyboard navigation, the space bar presses the focused control instead.
      if (ImGui::IsKeyPressed(one.key, false) && io.KeyCtrl == one.control &&
          (one.key != GLFW_KEY_SPACE || !io.NavVisible))
        key(one);
    for (int i = 0; i < static_cast<int>(panels.size()) && !io.KeyCtrl; ++i)
      if (ImGui::IsKeyPressed(GLFW_KEY_1 + i, false))
        act("panel " + panels[static_cast<std::size_t>(i)].name + "\nfocus panels");
  }
  if (showsPanels || panels.empty()) panels = panelsOf(*session);
  draw();
  ImGui::Render();
  // A minimised window shows nothing.
  if (width == 0 || height == 0 || minimised) return;
  glViewport(0, 0, width, height);
  glClearColor(0.05f, 0.05f, 0.05f, 1.0f);
  glClear(GL_COLOR_BUFFER_BIT);
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  glfwSwapBuffers(window);
}

/// Returns whether the picture changed. An exception ends a script, but never a window, which may have
/// unsaved edits.
bool Window::State::stepSession(double seconds, bool scripted) {
  try {
    return session->step(seconds);
  } catch (const std::exception& error) {
    if (scripted) throw;
    session->say(error.what(), true);
    return true;
  }
}

void Window::wake() {
  glfwPostEmptyEvent();
}

void Window::run(Session& session, std::vector<Action> script) {
  State& s = *state_;
  s.session = &session;
  s.script = std::move(script);
  const bool scripted = !s.script.empty();
  s.readLayout();
  auto last = Clock::now();
  while (!glfwWindowShouldClose(s.window) && !(s.options.ends && s.options.ends())) {
    const double shortest = s.options.fpsLimit > 0.0 ? 1.0 / s.options.fpsLimit : 0.0;
    if (s.minimised || (s.soon == 0 && !session.moves() && !s.busyWithHands())) {
      glfwWaitEventsTimeout(scripted ? 0.01 : kWatchInterval);
    } else {
      glfwPollEvents();
      const double spent = std::chrono::duration<double>(Clock::now() - last).count();
      if (!scripted && spent < shortest) glfwWaitEventsTimeout(shortest - spent);
    }
    const auto now = Clock::now();
    const double seconds = std::chrono::duration<double>(now - last).count();
    last = now;
    if (s.stepSession(seconds, scripted)) {
      if (!session.picture().empty()) s.texture->show(session.picture());
      s.soon = std::max(s.soon, 1);
    }
    if (!s.advanceScript() && scripted && s.done == s.script.size() && !s.busyWithHands() && s.soon == 0) {
      // The window stays open after a script that does not close it.
      s.script.clear();
      s.done = 0;
    }
    // Without an event the window would look the same, so it is not drawn.
    if (s.soon == 0 && !s.touched && !s.busyWithHands() && s.script.empty()) continue;
    s.touched = false;
    const ImGuiIO& io = ImGui::GetIO();
    const bool touched = io.MouseDelta.x != 0.0f || io.MouseDelta.y != 0.0f || ImGui::IsAnyMouseDown();
    s.drawFrame(std::min(seconds, kLongestStep));
    if (s.soon > 0) --s.soon;
    if (touched) s.soon = std::max(s.soon, 1);
  }
  s.writeLayout();
}

}  // namespace lumivox::viewer
