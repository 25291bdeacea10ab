// Where things stand in the window, as far as that needs no window.
#pragma once

#include <optional>
#include <vector>

namespace lumivox::viewer {

/// Round numbers from `low` to `high` for a logarithmic axis: powers of ten where there are three of them,
/// otherwise as many more as it takes. Of positive bounds a factor of 2.25 or more apart there are two at
/// least.
std::vector<double> roundNumbers(double low, double high);

/// All lengths in the window's pixels.
struct Room {
  float width = 0.0f, height = 0.0f;
  float panels = 0.0f;          ///< their width beside the pictures
  float aroundPictures = 0.0f;  ///< above and below them, with their legends
};
/// Pictures side by side are wide: where panels beside them would make them smaller, the panels go below.
/// The height that is left to the pictures then. `aspect`: of all pictures together, width over height.
std::optional<float> heightAbovePanels(const Room& room, float aspect);

}  // namespace lumivox::viewer
