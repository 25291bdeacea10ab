// The colours of false colour, with the values that they stand for.
#include <fmt/format.h>

#include <algorithm>

#include "viewer/window_state.h"

namespace lumivox::viewer {

void Window::State::drawLegend(const ImVec2& corner, float width) const {
  const Picture& picture = session->picture();
  if (!picture.range) return;
  constexpr int kSteps = 64;
  static const std::vector<unsigned char> ramp = falseColourRamp(kSteps);
  ImDrawList* const list = ImGui::GetWindowDrawList();
  const float height = 14.0f * scale, step = std::min(width, 320.0f * scale) / kSteps;
  for (int i = 0; i < kSteps; ++i) {
    const auto* const colour = ramp.data() + 3 * static_cast<std::size_t>(i);
    const float left = corner.x + step * static_cast<float>(i);
    list->AddRectFilled(ImVec2(left, corner.y), ImVec2(left + step, corner.y + height),
                        IM_COL32(colour[0], colour[1], colour[2], 255));
  }
  const ImVec2 below(corner.x, corner.y + height);
  const ImVec2 size = ImGui::CalcTextSize(picture.legend.c_str());
  list->AddRectFilled(below, ImVec2(below.x + size.x, below.y + size.y), IM_COL32(0, 0, 0, 160));
  list->AddText(below, IM_COL32(255, 255, 255, 255), picture.legend.c_str());
}

}  // namespace lumivox::viewer
