// Draws the window's contents, and handles the mouse.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "viewer/arrangement.h"
#include "viewer/window_state.h"

namespace lumivox::viewer {
namespace {

constexpr float kPanelWidth = 420.0f;    // pixels at a scale of 1
constexpr float kControlShare = 0.42f;   // of the width; label and resets need the rest
constexpr double kDragShare = 0.01;      // of the largest of three numbers, per pixel
constexpr double kTurnPerPixel = 0.005;  // rad
constexpr double kZoomPerNotch = 0.9;

}  // namespace

void Window::State::drawPicture(const ImVec2& low, const ImVec2& size) {
  ImGui::SetNextWindowPos(low);
  ImGui::SetNextWindowSize(size);
  ImGui::Begin("picture", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoScrollWithMouse |
                   ImGuiWindowFlags_NoNavInputs);
  if (focus == "picture") ImGui::SetWindowFocus();
  picturesKeyboard = ImGui::IsWindowFocused();
  const ImVec2 all = ImGui::GetContentRegionAvail();
  const ImVec2 room(all.x, std::max(std::min(all.y, 1.0f), all.y - legendHeight()));
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
    const bool drags = ImGui::IsItemActive() && (io.MouseDelta.x != 0.0f || io.MouseDelta.y != 0.0f);
    const bool splits = session->state().layout == Layout::split && ImGui::IsMouseDown(ImGuiMouseButton_Left);
    if (drags && splits)
      act(fmt::format("split {:.4f}", std::clamp((io.MousePos.x - corner.x) / shown.x, 0.0f, 1.0f)));
    else if (drags)
      act(fmt::format("{} {} rad {} rad", ImGui::IsMouseDown(ImGuiMouseButton_Left) ? "turn" : "orbit",
                      io.MouseDelta.x * kTurnPerPixel, -io.MouseDelta.y * kTurnPerPixel));
    if (ImGui::IsItemHovered()) {
      if (io.MouseWheel != 0.0f)
        act(fmt::format("zoom {}", std::pow(kZoomPerNotch, static_cast<double>(io.MouseWheel))));
      const int x = static_cast<int>((io.MousePos.x - corner.x) / factor),
                y = static_cast<int>((io.MousePos.y - corner.y) / factor);
      ImGui::BeginTooltip();
      for (const std::string& line : session->valuesAt(x, y)) ImGui::TextUnformatted(line.c_str());
      ImGui::EndTooltip();
    }
  } else {
    ImGui::TextUnformatted(session->problem().empty() ? "the first picture is being made ..." : "no picture");
  }
  drawLegends(ImVec2(low.x + 16.0f, low.y + size.y), size.x - 32.0f);
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
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const float width = std::max(32.0f, ImGui::GetContentRegionAvail().x);
  if (row.kind == Row::Kind::bars) return drawBars(row, corner, width);
  if (row.kind == Row::Kind::stacks) return drawStacks(row, corner, width);
  drawChart(row, corner, width);
}

void Window::State::drawChoice(const Panel& panel, const Row& row) {
  if (!ImGui::BeginCombo(row.label.c_str(), row.value.c_str())) return;
  for (const std::string& word : row.choices) {
    if (ImGui::Selectable(word.c_str(), word == row.value)) act(filledIn(row.statement, choiceValue(word)));
    controls[panel.name + "/" + row.name + "/" + word] = {ImGui::GetItemRectMin(), ImGui::GetItemRectMax()};
  }
  ImGui::EndCombo();
}

void Window::State::changeBy(const std::string& control, const std::string& statements) {
  session->joinChanges(moves == control);
  act(statements);
  session->joinChanges(false);
  // A drag of the mouse is one change.
  moves = ImGui::IsMouseDown(ImGuiMouseButton_Left) ? control : std::string();
}

/// Draws the two small buttons in front of a number. Returns -1 or 1 for the pressed one, else 0.
int Window::State::drawSteps(const std::string& name) {
  int pressed = 0;
  if (ImGui::SmallButton("-")) pressed = -1;
  controls[name + "/less"] = {ImGui::GetItemRectMin(), ImGui::GetItemRectMax()};
  ImGui::SameLine();
  if (ImGui::SmallButton("+")) pressed = 1;
  controls[name + "/more"] = {ImGui::GetItemRectMin(), ImGui::GetItemRectMax()};
  ImGui::SameLine();
  return pressed;
}

void Window::State::drawNumber(const Row& row, const std::string& name) {
  const auto change = [&](double value) {
    value = std::clamp(row.integer ? std::round(value) : value, row.low, row.high);
    if (value == row.number) return;
    changeBy(name,
             filledIn(row.statement, row.integer ? fmt::format("{:.0f}", value) : fmt::format("{}", value)));
  };
  const double step = row.integer && row.number <= 8.0 ? 1.0 : 0.0;
  const int pressed = drawSteps(name);
  if (pressed < 0) change(step > 0.0 ? row.number - step : row.number / (row.number < 0.0 ? 0.5 : 2.0));
  if (pressed > 0)
    change(row.number == 0.0                ? (row.integer ? 1.0 : row.high / 16.0)
           : step > 0.0 && row.number < 8.0 ? row.number + step
                                            : row.number * (row.number < 0.0 ? 0.5 : 2.0));
  double value = row.number;
  ImGui::SliderScalar(row.label.c_str(), ImGuiDataType_Double, &value, &row.low, &row.high,
                      row.integer ? "%.0f" : "%.5g", row.logarithmic ? ImGuiSliderFlags_Logarithmic : 0);
  if (ImGui::IsItemEdited()) change(value);
}

void Window::State::drawTriple(const Row& row, const std::string& name) {
  const auto change = [&](std::array<double, 3> values) {
    for (double& value : values) value = std::clamp(value, row.low, row.high);
    if (values != row.numbers) changeBy(name, filledIn(row.statement, written(values)));
  };
  std::array<double, 3> values = row.numbers;
  if (const int pressed = drawSteps(name); pressed != 0) {
    const bool none = values == std::array<double, 3>{};
    for (double& value : values) value = none && pressed > 0 ? 1.0 / 16.0 : value * (pressed < 0 ? 0.5 : 2.0);
    change(values);
    return;
  }
  const double largest = std::max({std::abs(values[0]), std::abs(values[1]), std::abs(values[2]), 0.1});
  ImGui::DragScalarN(row.label.c_str(), ImGuiDataType_Double, values.data(), 3,
                     static_cast<float>(kDragShare * largest), &row.low, &row.high, "%.4g");
  if (ImGui::IsItemEdited()) change(values);
}

/// Draws the reset buttons behind a control.
void Window::State::drawResets(const Row& row, const std::string& name) {
  for (const Row::Reset& reset : row.resets) {
    ImGui::SameLine();
    if (ImGui::SmallButton(reset.word.c_str())) act(reset.statement);
    controls[name + "/" + reset.word] = {ImGui::GetItemRectMin(), ImGui::GetItemRectMax()};
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", reset.statement.c_str());
  }
}

void Window::State::drawRow(const Panel& panel, const Row& row) {
  ImGui::PushID(row.name.c_str());
  const std::string name = panel.name + "/" + row.name;
  const auto place = [&] { controls[name] = {ImGui::GetItemRectMin(), ImGui::GetItemRectMax()}; };
  if (row.changed) ImGui::PushStyleColor(ImGuiCol_Text, IM_COL32(255, 200, 96, 255));
  ImGui::PushItemWidth(kControlShare * ImGui::GetContentRegionAvail().x);
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
    case Row::Kind::number:
      drawNumber(row, name);
      place();
      break;
    case Row::Kind::triple:
      drawTriple(row, name);
      place();
      break;
    case Row::Kind::bars:
    case Row::Kind::stacks:
    case Row::Kind::points:
      drawMarks(row);
      break;
  }
  const bool hovered = ImGui::IsItemHovered();
  if (!row.tooltip.empty() && row.marks.empty() && hovered) ImGui::SetTooltip("%s", row.tooltip.c_str());
  drawResets(row, name);
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
    ImGui::BeginChild("rows", ImVec2(0, 0), false, ImGuiWindowFlags_NavFlattened);
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
  ImGui::TextUnformatted("arrows  turn     shift arrows  orbit     page up, page down  nearer, farther");
  ImGui::TextUnformatted("1 to 7  the panels, by their order");
  for (const KeyStatement& one : keyStatements()) ImGui::Text("%-8s %s", one.name, one.meaning);
  ImGui::TextUnformatted(
      "In the panels: arrows and Tab go through the controls, space presses one, Enter types a number.");
  ImGui::End();
}

void Window::State::draw() {
  controls.clear();
  const ImVec2 all = ImGui::GetIO().DisplaySize;
  const float side = showsPanels ? std::min(panelWidth * scale, 0.6f * all.x) : 0.0f;
  std::optional<float> above;
  if (showsPanels && session->state().layout == Layout::sideBySide && texture->width() > 0)
    above = heightAbovePanels(
        {all.x, all.y, side, legendHeight() + 2.0f * ImGui::GetStyle().WindowPadding.y},
        static_cast<float>(texture->width()) / static_cast<float>(std::max(1, texture->height())));
  drawPicture(ImVec2(0, 0), above ? ImVec2(std::max(1.0f, all.x), *above)
                                  : ImVec2(std::max(1.0f, all.x - side), std::max(1.0f, all.y)));
  if (showsPanels) {
    ImGui::SetNextWindowPos(above ? ImVec2(0, *above) : ImVec2(all.x - side, 0));
    ImGui::SetNextWindowSize(above ? ImVec2(std::max(1.0f, all.x), std::max(1.0f, all.y - *above))
                                   : ImVec2(std::max(1.0f, side), std::max(1.0f, all.y)));
    ImGui::Begin("panels", nullptr,
                 ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize |
                     ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings);
    if (focus == "panels") ImGui::SetWindowFocus();
    drawPanels();
    ImGui::End();
  }
  focus.clear();
  drawHelp();
  drawQuestion();
}

void Window::State::drawQuestion() {
  const std::string question = session->question();
  if (question.empty()) return;
  if (!ImGui::IsPopupOpen("question")) ImGui::OpenPopup("question");
  if (!ImGui::BeginPopupModal(
          "question", nullptr,
          ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoTitleBar))
    return;
  ImGui::TextUnformatted(question.c_str());
  for (const char* answer : {"no", "yes"}) {
    if (ImGui::Button(answer) || (answer == std::string("no") && ImGui::IsKeyPressed(GLFW_KEY_ESCAPE, false)))
      act(std::string("answer ") + answer);
    if (answer == std::string("no")) ImGui::SetItemDefaultFocus();
    controls[std::string("question/") + answer] = {ImGui::GetItemRectMin(), ImGui::GetItemRectMax()};
    ImGui::SameLine();
  }
  if (session->question().empty()) ImGui::CloseCurrentPopup();
  ImGui::EndPopup();
}

}  // namespace lumivox::viewer
