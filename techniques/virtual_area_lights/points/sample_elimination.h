// Chooses blue noise from many samples of a surface.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "surface_candidates.h"

namespace lumivox::virtual_area_lights {

/// Weighted sample elimination (Yuksel 2015): removes the most crowded candidate until the rest weighs at
/// most `most` or is one, and returns the rest in order. `weights` has one per candidate. Candidates on two
/// sides of a wall do not crowd each other, unless one of them stands for both sides (a weight of 2).
std::vector<std::uint32_t> eliminateSamples(const SurfaceCandidates& candidates, std::span<const int> weights,
                                            std::size_t most);

}  // namespace lumivox::virtual_area_lights
