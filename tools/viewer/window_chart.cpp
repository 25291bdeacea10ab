// The chart of tried settings: error against time.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "viewer/arrangement.h"
#include "viewer/window_state.h"

namespace lumivox::viewer {
namespace {

constexpr ImU32 kLine = IM_COL32(128, 128, 128, 255), kGrid = IM_COL32(64, 64, 64, 255),
                kText = IM_COL32(200, 200, 200, 255);

/// A logarithmic axis.
struct Axis {
  double low = 1e300, high = 0.0, least = 0.0;
  double seen(double value) const { return std::max(value, least); }
  void add(double value) {
    low = std::min(low, seen(value));
    high = std::max(high, seen(value));
  }
  /// Position along the axis, 0..1.
  float at(double value) const {
    return static_cast<float>(std::log(seen(value) / low) / std::log(high / low));
  }
};

}  // namespace

void Window::State::drawChart(const Row& row, const ImVec2& corner, float width) {
  Axis horizontal{.least = 1e-6}, vertical{.least = 1e-9};
  for (const Row::Mark& mark : row.marks) horizontal.add(mark.x), vertical.add(mark.y);
  for (Axis* axis : {&horizontal, &vertical}) axis->low /= 1.5, axis->high *= 1.5;
  const auto written = [](double number) { return fmt::format("{:.6g}", number); };
  const float height = 140.0f * scale, line = ImGui::GetTextLineHeight(), gap = 4.0f * scale;
  float left = 0.0f;
  const std::vector<double> errors = roundNumbers(vertical.low, vertical.high);
  for (const double number : errors)
    left = std::max(left, ImGui::CalcTextSize(written(number).c_str()).x + gap);
  const ImVec2 low(corner.x + left, corner.y),
      high(corner.x + std::max(left + 16.0f * scale, width - 1.0f), corner.y + height);
  const auto placeOf = [&](double x, double y) {
    return ImVec2(low.x + horizontal.at(x) * (high.x - low.x), high.y - vertical.at(y) * height);
  };
  ImDrawList* const list = ImGui::GetWindowDrawList();
  float lowest = high.y + line;  // top of the last number beside the chart
  for (const double number : errors) {
    const float y = placeOf(horizontal.low, number).y;
    list->AddLine(ImVec2(low.x, y), ImVec2(high.x, y), kGrid);
    if (y + 0.5f * line > lowest) continue;
    lowest = y - 0.5f * line;
    const std::string word = written(number);
    list->AddText(ImVec2(low.x - gap - ImGui::CalcTextSize(word.c_str()).x, y - 0.5f * line), kText,
                  word.c_str());
  }
  float free = corner.x;  // right end of the last number below the chart
  for (const double number : roundNumbers(horizontal.low, horizontal.high)) {
    const float x = placeOf(number, vertical.low).x;
    list->AddLine(ImVec2(x, low.y), ImVec2(x, high.y), kGrid);
    const std::string word = written(number);
    const float half = 0.5f * ImGui::CalcTextSize(word.c_str()).x;
    if (x - half < free || x + half > corner.x + width) continue;
    list->AddText(ImVec2(x - half, high.y + gap), kText, word.c_str());
    free = x + half + gap;
  }
  list->AddRect(low, high, kLine);
  for (std::size_t i = 0; i < row.marks.size(); ++i) {
    const Row::Mark& mark = row.marks[i];
    const ImVec2 at = placeOf(mark.x, mark.y);
    const float radius = 4.0f * scale;
    const ImVec2 from(at.x - radius, at.y - radius), to(at.x + radius, at.y + radius);
    controls["judge/tried " + std::to_string(i)] = {from, to};
    const bool hovered = ImGui::IsMouseHoveringRect(from, to);
    list->AddCircleFilled(at, radius, hovered ? IM_COL32(255, 255, 255, 255) : IM_COL32(255, 160, 32, 255));
    if (hovered) {
      ImGui::SetTooltip("%s: %.2f ms, FLIP %.4g", mark.label.c_str(), mark.x, mark.y);
      if (ImGui::IsMouseClicked(ImGuiMouseButton_Left)) act(mark.statement);
    }
  }
  ImGui::Dummy(ImVec2(width, height + gap + line));
}

}  // namespace lumivox::viewer
