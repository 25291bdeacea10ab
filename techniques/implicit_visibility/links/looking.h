// Finds what all leaves see: links of inner nodes are pushed down to them (Dong et al. 2007, Sec. 4.2.3 and
// 4.2.4).
#pragma once

#include "element_links.h"
#include "sight.h"

namespace lumivox::implicit_visibility {

/// How a leaf takes over its ancestors' links. rebinned: the leaf sees their partners anew. kept: the leaf
/// keeps the bin and distance in which the ancestor saw them, as published.
enum class Push { rebinned, kept };

/// Partners that both stand still, or of which one moves.
struct Partners {
  const ElementLists<std::uint32_t>* lists =
      nullptr;  ///< of each node; null: every leaf with every other one
  bool moving = false;
};

class Lookout {
 public:
  Lookout(const ElementTree& tree, const ElementState& state, const BinFinder& finder, Fill fill, Push push)
      : tree_(tree), state_(state), finder_(finder), discs_(tree, state), fill_(fill), push_(push) {}

  /// For each leaf and bin, the nearest among the partners of the leaf and its ancestors and among what was
  /// seen `before` (null: nothing). The result does not depend on the number of threads.
  ElementLists<BinnedSight> look(const Partners& partners, const ElementLists<BinnedSight>* before) const;
  /// Estimates the number of these links from what some of the leaves see.
  std::uint64_t estimate(const Partners& partners) const;

 private:
  void lookFrom(Eye& eye, std::uint32_t leaf, const Partners& partners,
                const ElementLists<BinnedSight>& inner) const;
  void seeAllLeaves(Eye& eye, std::uint32_t leaf, bool moving) const;
  /// For each node above the leaves, what it sees of its own partners.
  ElementLists<BinnedSight> lookFromInner(const Partners& partners) const;
  template <class Look>
  ElementLists<BinnedSight> collect(std::uint32_t count, const Look& look) const;

  const ElementTree& tree_;
  const ElementState& state_;
  const BinFinder& finder_;
  DiscTree discs_;
  Fill fill_;
  Push push_;
};

}  // namespace lumivox::implicit_visibility
