#include "viewer/window.h"

#include <epoxy/gl.h>
// After epoxy, which brings OpenGL.
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <random>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/image.h"
#include "viewer/panels.h"

namespace lumivox::viewer {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kLongestWait = 60.0;    // s, of a script's `wait`
constexpr double kWatchInterval = 0.25;  // s between looks at the files while nothing happens
constexpr float kPanelWidth = 420.0f;    // pixels at a scale of 1
constexpr double kWalkSeconds = 4.0;     // to walk through the whole scene
constexpr double kTurnPerPixel = 0.005;  // rad
constexpr double kZoomPerNotch = 0.9;

std::string& lastGlfwError() {
  static std::string text;
  return text;
}

/// A picture on the screen's side.
class ScreenTexture {
 public:
  ~ScreenTexture() { glDeleteTextures(1, &name_); }
  void show(const Picture& picture) {
    if (name_ == 0) glGenTextures(1, &name_);
    glBindTexture(GL_TEXTURE_2D, name_);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    if (picture.width != width_ || picture.height != height_) {
      glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB8, picture.width, picture.height, 0, GL_RGB, GL_UNSIGNED_BYTE,
                   picture.bytes.data());
      glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
      glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
      width_ = picture.width;
      height_ = picture.height;
    } else {
      glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width_, height_, GL_RGB, GL_UNSIGNED_BYTE,
                      picture.bytes.data());
    }
  }
  ImTextureID id() const { return reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(name_)); }
  int width() const { return width_; }
  int height() const { return height_; }

 private:
  GLuint name_ = 0;
  int width_ = 0, height_ = 0;
};

struct KeyStatement {
  int key;
  bool control;
  const char *name, *statement, *meaning;
};
const KeyStatement kKeys[] = {
    {GLFW_KEY_K, false, "K", "keep_everything", "keep everything, or leave out"},
    {GLFW_KEY_SPACE, false, "space", "play", "play, or stand still"},
    {GLFW_KEY_PERIOD, false, ".", "step", "a frame on"},
    {GLFW_KEY_P, false, "P", "layout picture", "the picture"},
    {GLFW_KEY_R, false, "R", "layout reference", "the reference"},
    {GLFW_KEY_B, false, "B", "layout side_by_side", "picture, reference and error side by side"},
    {GLFW_KEY_F, false, "F", "layout flicker", "picture and reference in turn"},
    {GLFW_KEY_X, false, "X", "layout split", "picture and reference, split"},
    {GLFW_KEY_V, false, "V", "layout error", "the error"},
    {GLFW_KEY_Z, true, "ctrl Z", "undo 1", "undo"},
    {GLFW_KEY_Y, true, "ctrl Y", "redo 1", "redo"},
    {GLFW_KEY_F5, false, "F5", "reload on", "read all texts and libraries again"},
    {GLFW_KEY_F2, false, "F2", "save_image \"out/view.exr\"", "keep all outputs"},
    {GLFW_KEY_H, false, "H", "panels", "show or hide the panels"},
    {GLFW_KEY_SLASH, false, "?", "help", "this help"},
};

struct Rectangle {
  ImVec2 low{0, 0}, high{0, 0};
};

}  // namespace

struct Window::State {
  WindowOptions options;
  GLFWwindow* window = nullptr;
  float scale = 1.0f;
  std::string layoutFile;
  std::unique_ptr<ScreenTexture> texture;
  Session* session = nullptr;
  std::vector<Panel> panels;
  std::string openPanel = "look", wantedPanel;
  bool showsHelp = false, showsPanels = true;
  std::map<std::string, Rectangle> controls;  ///< of this frame, "panel/row"
  Rectangle image;                            ///< of the picture on the screen

  std::vector<Action> script;
  std::size_t done = 0;
  Clock::time_point waitsSince;
  bool waits = false;
  /// A click of a script takes three frames: there, down, up.
  struct Click {
    ImVec2 at;
    int frame = 0;
  };
  std::optional<Click> click;
  int soon = 3;  ///< frames that are drawn whatever happens: ImGui needs some to settle

  void act(const std::string& statements);
  void key(const KeyStatement& key);
  void walk(double seconds);
  void draw();
  void drawPicture(const ImVec2& low, const ImVec2& size);
  void drawPanels();
  void drawRow(const Panel& panel, const Row& row);
  void drawChoice(const Panel& panel, const Row& row);
  void drawMarks(const Row& row);
  void drawHelp();
  void drawProblem(const ImVec2& at, float width);
  void feedClick();
  bool advanceScript();
  bool doInWindow(const Action& action);
  bool waitIsOver(const Action& action);
  void shoot(const std::filesystem::path& file);
  void resize(int width, int height);
  void randomActions(int count);
};

void Window::State::act(const std::string& statements) {
  for (const Action& action : session->perform(statements)) doInWindow(action);
  soon = 3;
}

void Window::State::key(const KeyStatement& pressedKey) {
  const ViewState& state = session->state();
  const std::string statement = pressedKey.statement;
  if (statement == "help") {
    showsHelp = !showsHelp;
  } else if (statement == "panels") {
    showsPanels = !showsPanels;
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
  const Camera camera = cameraOf(session->state(), session->scene());
  const double step = glm::length(camera.target - camera.eye) * seconds / kWalkSeconds;
  act(fmt::format("move {} {} {}", way.x * step, way.y * step, way.z * step));
}

// ---- drawing

void Window::State::drawPicture(const ImVec2& low, const ImVec2& size) {
  ImGui::SetNextWindowPos(low);
  ImGui::SetNextWindowSize(size);
  ImGui::Begin("picture", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoScrollWithMouse);
  const ImVec2 room = ImGui::GetContentRegionAvail();
  if (texture->width() > 0 && room.x >= 1.0f && room.y >= 1.0f) {
    const float factor = std::min(room.x / static_cast<float>(texture->width()),
                                  room.y / static_cast<float>(texture->height()));
    const ImVec2 shown(std::max(1.0f, static_cast<float>(texture->width()) * factor),
                       std::max(1.0f, static_cast<float>(texture->height()) * factor));
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    image = {corner, ImVec2(corner.x + shown.x, corner.y + shown.y)};
    ImGui::Image(texture->id(), shown);
    ImGui::SetCursorScreenPos(corner);
    ImGui::InvisibleButton("hand", shown,
                           ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight);
    const ImGuiIO& io = ImGui::GetIO();
    if (ImGui::IsItemActive() && (io.MouseDelta.x != 0.0f || io.MouseDelta.y != 0.0f))
      act(fmt::format("{} {} rad {} rad", ImGui::IsMouseDown(ImGuiMouseButton_Left) ? "turn" : "orbit",
                      io.MouseDelta.x * kTurnPerPixel, -io.MouseDelta.y * kTurnPerPixel));
    if (ImGui::IsItemHovered()) {
      if (io.MouseWheel != 0.0f)
        act(fmt::format("zoom {}", std::pow(kZoomPerNotch, static_cast<double>(io.MouseWheel))));
      const int x = static_cast<int>((io.MousePos.x - corner.x) / factor),
                y = static_cast<int>((io.MousePos.y - corner.y) / factor);
      ImGui::BeginTooltip();
      for (const std::string& line : session->valuesAt(x % session->state().width, y))
        ImGui::TextUnformatted(line.c_str());
      ImGui::EndTooltip();
    }
  } else {
    ImGui::TextUnformatted(session->problem().empty() ? "the first picture is being made ..." : "no picture");
  }
  drawProblem(ImVec2(low.x + 8.0f, low.y + 8.0f), size.x - 16.0f);
  ImGui::End();
}

void Window::State::drawProblem(const ImVec2& at, float width) {
  const std::string problem = session->problem();
  const std::string text = problem.empty() ? session->message() : problem;
  if (text.empty()) return;
  const bool bad = !problem.empty() || session->messageIsError();
  ImGui::SetCursorScreenPos(at);
  ImGui::PushTextWrapPos(at.x + width);
  const ImVec2 size = ImGui::CalcTextSize(text.c_str(), nullptr, false, width);
  ImGui::GetWindowDrawList()->AddRectFilled(ImVec2(at.x - 4, at.y - 2),
                                            ImVec2(at.x + size.x + 4, at.y + size.y + 2),
                                            bad ? IM_COL32(96, 0, 0, 220) : IM_COL32(0, 0, 0, 160));
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopTextWrapPos();
}

void Window::State::drawMarks(const Row& row) {
  ImGui::TextUnformatted(row.label.c_str());
  if (row.marks.empty()) {
    ImGui::TextUnformatted("  nothing yet");
    return;
  }
  ImDrawList* const list = ImGui::GetWindowDrawList();
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const float width = std::max(32.0f, ImGui::GetContentRegionAvail().x);
  if (row.kind == Row::Kind::bars) {
    double all = 0.0;
    for (const Row::Mark& mark : row.marks) all += mark.x;
    const float height = 18.0f * scale;
    float at = corner.x;
    for (std::size_t i = 0; i < row.marks.size() && all > 0.0; ++i) {
      const float next = at + width * static_cast<float>(row.marks[i].x / all);
      const ImU32 colour = ImColor::HSV(
          static_cast<float>(i) * 0.618f - std::floor(static_cast<float>(i) * 0.618f), 0.6f, 0.8f);
      list->AddRectFilled(ImVec2(at, corner.y), ImVec2(next, corner.y + height), colour);
      if (ImGui::IsMouseHoveringRect(ImVec2(at, corner.y), ImVec2(next, corner.y + height)))
        ImGui::SetTooltip("%s: %.3f ms", row.marks[i].label.c_str(), row.marks[i].x);
      at = next;
    }
    ImGui::Dummy(ImVec2(width, height));
    return;
  }
  // Both axes logarithmic: equal factors are equal ways.
  const float height = 140.0f * scale;
  double lowX = 1e300, highX = 0.0, lowY = 1e300, highY = 0.0;
  for (const Row::Mark& mark : row.marks) {
    lowX = std::min(lowX, std::max(mark.x, 1e-6)), highX = std::max(highX, std::max(mark.x, 1e-6));
    lowY = std::min(lowY, std::max(mark.y, 1e-9)), highY = std::max(highY, std::max(mark.y, 1e-9));
  }
  lowX /= 1.5, highX *= 1.5, lowY /= 1.5, highY *= 1.5;
  list->AddRect(corner, ImVec2(corner.x + width, corner.y + height), IM_COL32(128, 128, 128, 255));
  for (std::size_t i = 0; i < row.marks.size(); ++i) {
    const Row::Mark& mark = row.marks[i];
    const auto x = static_cast<float>(std::log(std::max(mark.x, 1e-6) / lowX) / std::log(highX / lowX)),
               y = static_cast<float>(std::log(std::max(mark.y, 1e-9) / lowY) / std::log(highY / lowY));
    const ImVec2 at(corner.x + x * width, corner.y + (1.0f - y) * height);
    const float radius = 4.0f * scale;
    const ImVec2 low(at.x - radius, at.y - radius), high(at.x + radius, at.y + radius);
    controls["judge/tried " + std::to_string(i)] = {low, high};
    const bool hovered = ImGui::IsMouseHoveringRect(low, high);
    list->AddCircleFilled(at, radius, hovered ? IM_COL32(255, 255, 255, 255) : IM_COL32(255, 160, 32, 255));
    if (hovered) {
      ImGui::SetTooltip("%s: %.2f ms, RMSE %.4g", mark.label.c_str(), mark.x, mark.y);
      if (ImGui::IsMouseClicked(ImGuiMouseButton_Left)) act(mark.statement);
    }
  }
  ImGui::Dummy(ImVec2(width, height));
}

void Window::State::drawChoice(const Panel& panel, const Row& row) {
  if (!ImGui::BeginCombo(row.label.c_str(), row.value.c_str())) return;
  for (const std::string& word : row.choices) {
    if (ImGui::Selectable(word.c_str(), word == row.value)) act(filledIn(row.statement, choiceValue(word)));
    controls[panel.name + "/" + row.name + "/" + word] = {ImGui::GetItemRectMin(), ImGui::GetItemRectMax()};
  }
  ImGui::EndCombo();
}

void Window::State::drawRow(const Panel& panel, const Row& row) {
  ImGui::PushID(row.name.c_str());
  const std::string name = panel.name + "/" + row.name;
  const auto place = [&] { controls[name] = {ImGui::GetItemRectMin(), ImGui::GetItemRectMax()}; };
  if (row.changed) ImGui::PushStyleColor(ImGuiCol_Text, IM_COL32(255, 200, 96, 255));
  ImGui::PushItemWidth(0.5f * ImGui::GetContentRegionAvail().x);
  switch (row.kind) {
    case Row::Kind::heading:
      ImGui::Separator();
      ImGui::TextUnformatted(row.label.c_str());
      break;
    case Row::Kind::text:
      ImGui::TextWrapped("%s%s%s", row.label.c_str(), row.label.empty() ? "" : ": ", row.value.c_str());
      place();
      break;
    case Row::Kind::toggle: {
      bool on = row.on;
      if (ImGui::Checkbox(row.label.c_str(), &on)) act(filledIn(row.statement, on ? "on" : "off"));
      place();
      break;
    }
    case Row::Kind::button:
      if (ImGui::Button(row.label.c_str())) act(row.statement);
      place();
      break;
    case Row::Kind::choice:
      drawChoice(panel, row);
      place();
      break;
    case Row::Kind::number: {
      const auto change = [&](double value) {
        value = std::clamp(value, row.low, row.high);
        act(filledIn(row.statement, row.integer ? fmt::format("{:.0f}", value) : fmt::format("{}", value)));
      };
      const double less = row.integer && row.number <= 8.0 ? row.number - 1.0 : row.number / 2.0,
                   more = row.number == 0.0                 ? (row.integer ? 1.0 : row.high / 16.0)
                          : row.integer && row.number < 8.0 ? row.number + 1.0
                                                            : row.number * 2.0;
      if (ImGui::SmallButton("-")) change(row.integer ? std::floor(less) : less);
      controls[name + "/less"] = {ImGui::GetItemRectMin(), ImGui::GetItemRectMax()};
      ImGui::SameLine();
      if (ImGui::SmallButton("+")) change(more);
      controls[name + "/more"] = {ImGui::GetItemRectMin(), ImGui::GetItemRectMax()};
      ImGui::SameLine();
      double value = row.number;
      const double low = row.low, high = row.high;
      ImGui::SliderScalar(row.label.c_str(), ImGuiDataType_Double, &value, &low, &high,
                          row.integer ? "%.0f" : "%.5g", row.logarithmic ? ImGuiSliderFlags_Logarithmic : 0);
      if (ImGui::IsItemEdited() && value != row.number) change(row.integer ? std::round(value) : value);
      place();
      break;
    }
    case Row::Kind::bars:
    case Row::Kind::points:
      drawMarks(row);
      break;
  }
  if (!row.tooltip.empty() && row.kind != Row::Kind::bars && row.kind != Row::Kind::points &&
      ImGui::IsItemHovered())
    ImGui::SetTooltip("%s", row.tooltip.c_str());
  ImGui::PopItemWidth();
  if (row.changed) ImGui::PopStyleColor();
  ImGui::PopID();
}

void Window::State::drawPanels() {
  if (!ImGui::BeginTabBar("panels")) return;
  for (const Panel& panel : panels) {
    const ImGuiTabItemFlags flags = wantedPanel == panel.name ? ImGuiTabItemFlags_SetSelected : 0;
    const bool open = ImGui::BeginTabItem(panel.title.c_str(), nullptr, flags);
    controls["panel/" + panel.name] = {ImGui::GetItemRectMin(), ImGui::GetItemRectMax()};
    if (!open) continue;
    openPanel = panel.name;
    ImGui::BeginChild("rows");
    for (const Row& row : panel.rows) drawRow(panel, row);
    ImGui::EndChild();
    ImGui::EndTabItem();
  }
  wantedPanel.clear();
  ImGui::EndTabBar();
}

void Window::State::drawHelp() {
  if (!showsHelp) return;
  ImGui::SetNextWindowPos(ImVec2(40.0f * scale, 40.0f * scale), ImGuiCond_Appearing);
  ImGui::Begin("Keys", &showsHelp, ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings);
  ImGui::TextUnformatted("W A S D  forward, left, back, right     Q E  down, up");
  ImGui::TextUnformatted("left button  turn     right button  orbit     wheel  nearer");
  for (const KeyStatement& one : kKeys) ImGui::Text("%-8s %s", one.name, one.meaning);
  ImGui::TextUnformatted("Tab goes through the controls of a panel that has the focus, Enter changes one.");
  ImGui::End();
}

void Window::State::draw() {
  controls.clear();
  const ImVec2 all = ImGui::GetIO().DisplaySize;
  const float side = showsPanels ? std::min(kPanelWidth * scale, 0.6f * all.x) : 0.0f;
  drawPicture(ImVec2(0, 0), ImVec2(std::max(1.0f, all.x - side), std::max(1.0f, all.y)));
  if (showsPanels) {
    ImGui::SetNextWindowPos(ImVec2(all.x - side, 0));
    ImGui::SetNextWindowSize(ImVec2(std::max(1.0f, side), std::max(1.0f, all.y)));
    ImGui::Begin("panels", nullptr,
                 ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize |
                     ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings);
    drawPanels();
    ImGui::End();
  }
  drawHelp();
}

// ---- scripts

void Window::State::feedClick() {
  if (!click) return;
  ImGuiIO& io = ImGui::GetIO();
  io.MousePos = click->at;
  io.MouseDown[0] = click->frame == 2;
  soon = 3;
  if (++click->frame > 4) click.reset();
}

bool Window::State::waitIsOver(const Action& action) {
  const std::string what = action.text();
  if (std::chrono::duration<double>(Clock::now() - waitsSince).count() > kLongestWait)
    throw Error(fmt::format("{}: `{}` took more than {} s; {}", action.place().text(), action.written(),
                            kLongestWait, session->problem()));
  if (what == "frame") return session->settled();
  if (what == "judged") return session->judgedNow();
  if (what == "problem") return !session->problem().empty();
  if (what == "mended") return session->problem().empty();
  if (what == "reference") {
    const ReferenceResult reference = session->reference();
    const int wanted = action.property->values.size() > 1 ? static_cast<int>(action.number(1)) : 2;
    return session->settled() && reference != nullptr && reference->samples >= wanted;
  }
  throw Error(fmt::format("{}: wait {}: expected frame, judged, problem, mended or reference",
                          action.place().text(), what));
}

void Window::State::resize(int width, int height) {
  glfwSetWindowSize(window, width, height);
  soon = 4;
}

bool Window::State::doInWindow(const Action& action) {
  const std::string& word = action.word();
  if (word == "click") {
    const auto found = controls.find(action.text());
    if (found == controls.end()) {
      std::vector<std::string> names;
      for (const auto& [name, place] : controls) names.push_back(name);
      const std::string nearest = nearestWord(action.text(), names);
      throw Error(fmt::format("{}: click '{}': there is no such control in the open panel '{}'{}",
                              action.place().text(), action.text(), openPanel,
                              nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
    }
    const Rectangle& at = found->second;
    click = {ImVec2(0.5f * (at.low.x + at.high.x), 0.5f * (at.low.y + at.high.y)), 0};
    // A box's label belongs to it, its middle may not.
    click->at.x = std::min(click->at.x, at.low.x + 10.0f * scale);
  } else if (word == "key") {
    for (const KeyStatement& one : kKeys)
      if (one.name == action.text()) return key(one), true;
    throw Error(fmt::format("{}: key '{}': nothing is bound to it", action.place().text(), action.text()));
  } else if (word == "panel") {
    wantedPanel = action.text();
    if (std::none_of(panels.begin(), panels.end(), [&](const Panel& one) { return one.name == wantedPanel; }))
      throw Error(fmt::format("{}: there is no panel '{}'", action.place().text(), wantedPanel));
    soon = 4;
  } else if (word == "window") {
    const std::vector<double> n = action.numbers();
    resize(static_cast<int>(n[0]), static_cast<int>(n[1]));
  } else if (word == "shot") {
    shoot(action.text());
  } else if (word == "random") {
    randomActions(static_cast<int>(action.number()));
  } else if (word == "quit") {
    glfwSetWindowShouldClose(window, GLFW_TRUE);
  } else {
    return false;
  }
  return true;
}

void Window::State::randomActions(int count) {
  std::mt19937_64 random(session->state().seed);
  for (int i = 0; i < count; ++i) {
    panels = panelsOf(*session);
    const Panel& panel = panels[random() % panels.size()];
    if (panel.name == "keep" || panel.rows.empty()) continue;  // nothing is written
    const Row& row = panel.rows[random() % panel.rows.size()];
    std::string statement = row.statement;
    if (row.kind == Row::Kind::choice && !row.choices.empty())
      statement = filledIn(statement, choiceValue(row.choices[random() % row.choices.size()]));
    if (row.kind == Row::Kind::toggle) statement = filledIn(statement, random() % 2 == 0 ? "on" : "off");
    if (row.kind == Row::Kind::number) {
      const double share = static_cast<double>(random() % 1000) / 999.0;
      // Small values: a script of many is not to wait for the largest grid.
      const double high = std::min(row.high, row.low + 64.0), value = row.low + share * (high - row.low);
      statement = filledIn(statement, row.integer ? fmt::format("{:.0f}", value) : fmt::format("{}", value));
    }
    if (!statement.empty()) act(statement);
    session->step(0.01);
  }
}

void Window::State::shoot(const std::filesystem::path& file) {
  int width = 0, height = 0;
  glfwGetFramebufferSize(window, &width, &height);
  std::vector<unsigned char> bytes(4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, bytes.data());
  ImageBuffer pixels(width, height, 3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < 3; ++c)
        pixels.at(x, y, c) =
            static_cast<float>(
                bytes[4 * (static_cast<std::size_t>(height - 1 - y) * static_cast<std::size_t>(width) +
                           static_cast<std::size_t>(x)) +
                      static_cast<std::size_t>(c)]) /
            255.0f;
  createParentDirectories(file);
  writePng(file, pixels, {0.0, Tone::linear});
}

/// Does what it can without waiting; whether there is something left.
bool Window::State::advanceScript() {
  while (done < script.size() && !click && soon == 0) {
    const Action& action = script[done];
    if (action.word() == "wait") {
      if (!waits) waitsSince = Clock::now();
      waits = true;
      if (!waitIsOver(action)) return true;
      waits = false;
    } else {
      const std::string before = session->message();
      session->say({}, false);
      if (!session->perform(action)) doInWindow(action);
      if (session->messageIsError())
        throw Error(fmt::format("{}: {}: {}", action.place().text(), action.written(), session->message()));
      if (session->message().empty()) session->say(before, false);
      soon = std::max(soon, 2);
    }
    ++done;
  }
  return done < script.size();
}

// ---- the window itself

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
    const ImGuiIO& io = ImGui::GetIO();
    const bool touched = io.MouseDelta.x != 0.0f || io.MouseDelta.y != 0.0f || ImGui::IsAnyMouseDown();
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    s.feedClick();
    ImGui::NewFrame();
    if (!io.WantTextInput) {
      s.walk(std::min(seconds, 0.1));
      for (const KeyStatement& one : kKeys)
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
