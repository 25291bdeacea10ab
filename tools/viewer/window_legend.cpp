// Draws the legends of the colours below the pictures.
#include <fmt/format.h>

#include <algorithm>

#include "viewer/window_state.h"

namespace lumivox::viewer {
namespace {

constexpr float kRampHeight = 14.0f, kRampWidth = 320.0f, kTextHeight = 22.0f;  // at a scale of 1

}  // namespace

/// The height of all legends that have a ramp.
float Window::State::legendHeight() const {
  float height = 0.0f;
  for (const Legend& legend : session->picture().legends)
    if (!legend.ramp.empty()) height += (kRampHeight + kTextHeight) * scale;
  return height;
}

/// Draws the legends one below the other, the last at the bottom.
void Window::State::drawLegends(const ImVec2& bottom, float width) const {
  ImDrawList* const list = ImGui::GetWindowDrawList();
  ImVec2 corner(bottom.x, bottom.y - legendHeight());
  for (const Legend& legend : session->picture().legends) {
    if (legend.ramp.empty()) continue;
    const std::size_t steps = legend.ramp.size() / 3;
    const float height = kRampHeight * scale;
    const float step = std::min(width, kRampWidth * scale) / static_cast<float>(steps);
    for (std::size_t i = 0; i < steps; ++i) {
      const auto* const colour = legend.ramp.data() + 3 * i;
      const float left = corner.x + step * static_cast<float>(i);
      list->AddRectFilled(ImVec2(left, corner.y), ImVec2(left + step, corner.y + height),
                          IM_COL32(colour[0], colour[1], colour[2], 255));
    }
    const ImVec2 below(corner.x, corner.y + height);
    const ImVec2 size = ImGui::CalcTextSize(legend.text.c_str());
    list->AddRectFilled(below, ImVec2(below.x + size.x, below.y + size.y), IM_COL32(0, 0, 0, 160));
    list->AddText(below, IM_COL32(255, 255, 255, 255), legend.text.c_str());
    corner.y = below.y + kTextHeight * scale;
  }
}

}  // namespace lumivox::viewer
