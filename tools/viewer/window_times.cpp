// Draws bars of times.
#include <algorithm>
#include <cmath>

#include "viewer/window_state.h"

namespace lumivox::viewer {
namespace {

/// The colour of a pass. Successive hues are as far as possible from the earlier ones.
ImU32 colourOf(std::size_t index) {
  const float turn = static_cast<float>(index) * 0.618f;
  return ImColor::HSV(turn - std::floor(turn), 0.6f, 0.8f);
}

void bar(const ImVec2& low, const ImVec2& high, std::size_t index, const Row::Mark& mark, double ms) {
  ImGui::GetWindowDrawList()->AddRectFilled(low, high, colourOf(index));
  if (ImGui::IsMouseHoveringRect(low, high)) ImGui::SetTooltip("%s: %.3f ms", mark.label.c_str(), ms);
}

}  // namespace

void Window::State::drawBars(const Row& row, const ImVec2& corner, float width) const {
  double all = 0.0;
  for (const Row::Mark& mark : row.marks) all += mark.x;
  const float height = 18.0f * scale;
  float at = corner.x;
  for (std::size_t i = 0; i < row.marks.size() && all > 0.0; ++i) {
    const float next = at + width * static_cast<float>(row.marks[i].x / all);
    bar(ImVec2(at, corner.y), ImVec2(next, corner.y + height), i, row.marks[i], row.marks[i].x);
    at = next;
  }
  ImGui::Dummy(ImVec2(width, height));
}

void Window::State::drawStacks(const Row& row, const ImVec2& corner, float width) const {
  std::vector<double> sums;
  for (const Row::Mark& mark : row.marks) {
    sums.resize(std::max(sums.size(), static_cast<std::size_t>(mark.x) + 1), 0.0);
    sums[static_cast<std::size_t>(mark.x)] += mark.y;
  }
  const double highest = *std::max_element(sums.begin(), sums.end());
  const float height = 80.0f * scale;
  const float column = std::min(width / static_cast<float>(sums.size()), 12.0f * scale);
  std::vector<double> filled(sums.size(), 0.0);
  std::vector<std::size_t> passes(sums.size(), 0);
  for (const Row::Mark& mark : row.marks) {
    const auto frame = static_cast<std::size_t>(mark.x);
    const float left = corner.x + column * static_cast<float>(frame);
    const auto y = [&](double ms) {
      return corner.y + height * static_cast<float>(1.0 - (highest > 0.0 ? ms / highest : 0.0));
    };
    bar(ImVec2(left, y(filled[frame] + mark.y)),
        ImVec2(left + column - (column > 4.0f ? 1.0f : 0.0f), y(filled[frame])), passes[frame]++, mark,
        mark.y);
    filled[frame] += mark.y;
  }
  ImGui::GetWindowDrawList()->AddLine(ImVec2(corner.x, corner.y + height),
                                      ImVec2(corner.x + width, corner.y + height),
                                      IM_COL32(128, 128, 128, 255));
  ImGui::Dummy(ImVec2(width, height));
  ImGui::Text("highest: %.3f ms", highest);
}

}  // namespace lumivox::viewer
