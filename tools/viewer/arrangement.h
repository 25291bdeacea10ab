// The part of the window's layout that can be computed without a window.
#pragma once

#include <optional>
#include <vector>

namespace lumivox::viewer {

/// Round numbers from `low` to `high` for a logarithmic axis: powers of ten, or finer steps where fewer than
/// three powers fit. Positive bounds a factor of 2.25 or more apart give at least two numbers.
std::vector<double> roundNumbers(double low, double high);

/// All lengths in the window's pixels.
struct Room {
  float width = 0.0f, height = 0.0f;
  float panels = 0.0f;          ///< their width beside the pictures
  float aroundPictures = 0.0f;  ///< above and below them, with their legends
};
/// The height of the pictures if the panels go below them; nothing if they go beside. They go below where the
/// pictures are larger that way, as wide pictures are. `aspect`: width over height of all pictures together.
std::optional<float> heightAbovePanels(const Room& room, float aspect);

}  // namespace lumivox::viewer
