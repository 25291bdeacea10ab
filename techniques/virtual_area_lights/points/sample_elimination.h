// Blue noise out of many samples of a surface.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "surface_candidates.h"

namespace lumivox::virtual_area_lights {

/// Weighted sample elimination (Yuksel 2015): of the candidates, in their order, those that are left once the
/// most crowded has been taken away again and again, until what is left weighs at most `most`, or is one.
/// `weights`: of each candidate. Candidates on two sides of a wall do not crowd each other, unless one of
/// them is for both sides (a weight of 2).
std::vector<std::uint32_t> eliminateSamples(const SurfaceCandidates& candidates, std::span<const int> weights,
                                            std::size_t most);

}  // namespace lumivox::virtual_area_lights
