// Pairs of nodes that may exchange light (Dong et al. 2007, Sec. 4.2.2).
#pragma once

#include <cstdint>
#include <memory>

#include "element_links.h"

namespace lumivox::implicit_visibility {

struct PairSettings {
  DirectionBins bins{8, BinMapping::even};
  /// A node that covers more than so many bins is split; 0: all are, down to the leaves.
  float split = 2.0f;
};

/// Sorted partners of each node, listed at both ends of every pair: pairs of still nodes, or pairs with a
/// moving end. Exactly one pair of either kind joins any two leaves or ancestors of theirs; only nodes
/// without area have none. The lists are counted before they are allocated. Error where memory does not
/// suffice.
ElementLists<std::uint32_t> findPartners(const ElementTree& tree, const ElementState& state,
                                         const PairSettings& settings, bool moving);

}  // namespace lumivox::implicit_visibility
