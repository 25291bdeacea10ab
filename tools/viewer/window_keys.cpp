// Key bindings: each key performs a statement of a script or toggles something.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "viewer/window_state.h"

namespace lumivox::viewer {
namespace {

constexpr double kWalkSeconds = 4.0;  // to walk through the whole scene
constexpr double kTurnSpeed = 1.0;    // rad/s, by keys

}  // namespace

const std::vector<KeyStatement>& keyStatements() {
  static const std::vector<KeyStatement> keys{
      {GLFW_KEY_K, false, "K", "keep_everything", "keep everything, or leave out"},
      {GLFW_KEY_SPACE, false, "space", "play", "play, or stand still"},
      {GLFW_KEY_PERIOD, false, ".", "step", "a frame on"},
      {GLFW_KEY_HOME, false, "home", "frame \"all\"", "step back until all is seen"},
      {GLFW_KEY_P, false, "P", "layout picture", "the picture"},
      {GLFW_KEY_R, false, "R", "layout reference", "the reference"},
      {GLFW_KEY_B, false, "B", "layout side_by_side", "picture, reference and error side by side"},
      {GLFW_KEY_F, false, "F", "layout flicker", "picture and reference in turn"},
      {GLFW_KEY_X, false, "X", "layout split", "picture and reference, split"},
      {GLFW_KEY_V, false, "V", "layout error", "the error"},
      {GLFW_KEY_Z, true, "ctrl Z", "undo 1", "undo"},
      {GLFW_KEY_Y, true, "ctrl Y", "redo 1", "redo"},
      {GLFW_KEY_C, true, "ctrl C", "copy_command on", "the command that repeats the picture, to paste"},
      {GLFW_KEY_F5, false, "F5", "reload on", "read all texts and libraries again"},
      {GLFW_KEY_F2, false, "F2", "save_image \"out/view.exr\"", "keep all outputs"},
      {GLFW_KEY_H, false, "H", "panels", "show or hide the panels"},
      {GLFW_KEY_F6, false, "F6", "focus", "the keyboard to the picture, or to the panels"},
      {GLFW_KEY_LEFT_BRACKET, false, "[", "narrower", "narrower panels"},
      {GLFW_KEY_RIGHT_BRACKET, false, "]", "wider", "wider panels"},
      {GLFW_KEY_SLASH, false, "?", "help", "this help"},
  };
  return keys;
}

const std::map<std::string, int>& heldKeys() {
  static const std::map<std::string, int> keys = [] {
    std::map<std::string, int> all{{"left", GLFW_KEY_LEFT},       {"right", GLFW_KEY_RIGHT},
                                   {"up", GLFW_KEY_UP},           {"down", GLFW_KEY_DOWN},
                                   {"page up", GLFW_KEY_PAGE_UP}, {"page down", GLFW_KEY_PAGE_DOWN},
                                   {"tab", GLFW_KEY_TAB},         {"enter", GLFW_KEY_ENTER},
                                   {"escape", GLFW_KEY_ESCAPE},   {"press", GLFW_KEY_SPACE}};
    for (const char letter : {'W', 'A', 'S', 'D', 'Q', 'E'}) all[std::string(1, letter)] = letter;
    for (char digit = '1'; digit <= '9'; ++digit) all[std::string(1, digit)] = digit;
    return all;
  }();
  return keys;
}

void Window::State::act(const std::string& statements) {
  try {
    for (const Action& action : session->perform(statements)) doInWindow(action);
  } catch (const std::exception& error) {
    session->say(error.what(), true);  // as the session reports its own errors
  }
  soon = 3;
}

void Window::State::key(const KeyStatement& pressedKey) {
  const ViewState& state = session->state();
  const std::string statement = pressedKey.statement;
  if (statement == "help") {
    showsHelp = !showsHelp;
  } else if (statement == "panels") {
    act(showsPanels ? "panels off" : "panels on");
  } else if (statement == "focus") {
    act(picturesKeyboard ? "focus panels" : "focus picture");
  } else if (statement == "narrower" || statement == "wider") {
    const double width = panelWidth * (statement == "wider" ? 1.125 : 1.0 / 1.125);
    act(fmt::format("panel_width {:.0f}", std::clamp(width, 120.0, 4000.0)));
  } else if (statement == "keep_everything") {
    act(state.keepEverything ? "keep_everything off" : "keep_everything on");
  } else if (statement == "play") {
    act(state.plays ? "play off" : "play on");
  } else if (statement == "step") {
    act(fmt::format("time {}", state.time + 1.0 / 24.0));
  } else {
    act(statement);
  }
  soon = 3;
}

void Window::State::walk(double seconds) {
  glm::dvec3 way(0.0);
  const auto held = [&](int which) { return ImGui::IsKeyDown(which) ? 1.0 : 0.0; };
  way.x = held(GLFW_KEY_D) - held(GLFW_KEY_A);
  way.y = held(GLFW_KEY_E) - held(GLFW_KEY_Q);
  way.z = held(GLFW_KEY_W) - held(GLFW_KEY_S);
  if (way == glm::dvec3(0.0) || ImGui::GetIO().KeyCtrl) return;
  const Camera camera = cameraOf(session->state(), session->shownScene());
  const double step = glm::length(camera.target - camera.eye) * seconds / kWalkSeconds;
  act(fmt::format("move {} {} {}", way.x * step, way.y * step, way.z * step));
}

void Window::State::look(double seconds) {
  if (!picturesKeyboard) return;
  const auto held = [&](int which) { return ImGui::IsKeyDown(which) ? 1.0 : 0.0; };
  const double right = held(GLFW_KEY_RIGHT) - held(GLFW_KEY_LEFT),
               up = held(GLFW_KEY_UP) - held(GLFW_KEY_DOWN),
               nearer = held(GLFW_KEY_PAGE_UP) - held(GLFW_KEY_PAGE_DOWN);
  if (right != 0.0 || up != 0.0)
    act(fmt::format("{} {} rad {} rad", ImGui::GetIO().KeyShift ? "orbit" : "turn",
                    right * kTurnSpeed * seconds, up * kTurnSpeed * seconds));
  if (nearer != 0.0) act(fmt::format("zoom {}", std::pow(0.5, nearer * seconds)));
}

}  // namespace lumivox::viewer
