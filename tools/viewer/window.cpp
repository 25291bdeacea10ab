#include "viewer/window.h"

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <fmt/format.h>

#include <algorithm>

#include "lumivox/base/error.h"
#include "viewer/window_state.h"

namespace lumivox::viewer {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kWatchInterval = 0.25;  // s between looks at the files while nothing happens

std::string& lastGlfwError() {
  static std::string text;
  return text;
}

/// Sets `touched` whenever hands or the display do something. Before ImGui listens, which calls those it
/// finds.
void listenTo(GLFWwindow* window, bool& touched) {
  glfwSetWindowUserPointer(window, &touched);
  static const auto touch = [](GLFWwindow* of) { *static_cast<bool*>(glfwGetWindowUserPointer(of)) = true; };
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
  glfwSetWindowContentScaleCallback(window, [](GLFWwindow* of, float, float) { touch(of); });
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
  listenTo(s.window, s.touched);
  glfwMakeContextCurrent(s.window);
  glfwSwapInterval(1);
  float scaleY = 1.0f;
  glfwGetWindowContentScale(s.window, &s.scale, &scaleY);
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGuiIO& io = ImGui::GetIO();
  s.layoutFile = options.layoutFile.string();
  io.IniFilename = s.layoutFile.empty() ? nullptr : s.layoutFile.c_str();
  io.ConfigFlags |= ImGuiConfigFlags_NavEnableKeyboard;
  io.FontGlobalScale = s.scale;
  ImGui::StyleColorsDark();
  ImGui::GetStyle().ScaleAllSizes(s.scale);
  ImGui_ImplGlfw_InitForOpenGL(s.window, true);
  ImGui_ImplOpenGL3_Init("#version 450 core");
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

void Window::wake() {
  glfwPostEmptyEvent();
}

void Window::run(Session& session, std::vector<Action> script) {
  State& s = *state_;
  s.session = &session;
  s.script = std::move(script);
  const bool scripted = !s.script.empty();
  auto last = Clock::now();
  while (!glfwWindowShouldClose(s.window)) {
    const double shortest = s.options.fpsLimit > 0.0 ? 1.0 / s.options.fpsLimit : 0.0;
    if (s.soon == 0 && !session.moves() && !s.click) {
      glfwWaitEventsTimeout(scripted ? 0.01 : kWatchInterval);
    } else {
      glfwPollEvents();
      const double spent = std::chrono::duration<double>(Clock::now() - last).count();
      if (!scripted && spent < shortest) glfwWaitEventsTimeout(shortest - spent);
    }
    const auto now = Clock::now();
    const double seconds = std::chrono::duration<double>(now - last).count();
    last = now;
    if (session.step(seconds)) {
      if (!session.picture().empty()) s.texture->show(session.picture());
      s.soon = std::max(s.soon, 1);
    }
    if (!s.advanceScript() && scripted && s.done == s.script.size() && !s.click && s.soon == 0) {
      // The window stays open behind a script that does not close it.
      s.script.clear();
      s.done = 0;
    }
    // Nothing is drawn where nothing has happened: the panels would look as they do.
    if (s.soon == 0 && !s.touched && !s.click && s.script.empty()) continue;
    s.touched = false;
    const ImGuiIO& io = ImGui::GetIO();
    const bool touched = io.MouseDelta.x != 0.0f || io.MouseDelta.y != 0.0f || ImGui::IsAnyMouseDown();
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    s.feedClick();
    ImGui::NewFrame();
    if (!io.WantTextInput) {
      s.walk(std::min(seconds, 0.1));
      for (const KeyStatement& one : keyStatements())
        if (ImGui::IsKeyPressed(one.key, false) && io.KeyCtrl == one.control) s.key(one);
    }
    s.panels = panelsOf(session);
    s.draw();
    ImGui::Render();
    int width = 0, height = 0;
    glfwGetFramebufferSize(s.window, &width, &height);
    glViewport(0, 0, width, height);
    glClearColor(0.05f, 0.05f, 0.05f, 1.0f);
    glClear(GL_COLOR_BUFFER_BIT);
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
    glfwSwapBuffers(s.window);
    if (s.soon > 0) --s.soon;
    if (touched) s.soon = std::max(s.soon, 1);
  }
}

}  // namespace lumivox::viewer
