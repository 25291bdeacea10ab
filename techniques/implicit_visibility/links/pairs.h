// Pairs of nodes that may exchange light (Dong et al. 2007, Sec. 4.2.2).
#pragma once

#include <cstdint>
#include <memory>

#include "element_links.h"

namespace lumivox::implicit_visibility {

struct PairSettings {
  DirectionBins bins{8, BinMapping::even};
  /// A node is split where it covers more than so many bins; 0: all are, down to the leaves.
  float split = 2.0f;
};

/// Partners of each node, at both ends of every pair, sorted: among what stands still, or with at least one
/// end that moves. Every two leaves are joined by exactly one pair of them or of their ancestors, of one kind
/// or the other; only nodes without area have none. The lists are counted before room is taken. Error when
/// there is too little memory.
ElementLists<std::uint32_t> findPartners(const ElementTree& tree, const ElementState& state,
                                         const PairSettings& settings, bool moving);

}  // namespace lumivox::implicit_visibility
