#include "pairs.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "../room.h"

namespace lumivox::implicit_visibility {
namespace {

using Pair = std::pair<std::uint32_t, std::uint32_t>;

/// Walks down over pairs of nodes, beginning with the root paired with itself.
class PairWalk {
 public:
  PairWalk(const ElementTree& tree, const ElementState& state, const PairSettings& settings, bool moving)
      : tree_(tree),
        state_(state),
        split_(settings.split),
        moving_(moving),
        even_(settings.bins.mapping() == BinMapping::even),
        smallStep_((even_ ? 0.5f * std::numbers::pi_v<float> : 2.0f) /
                   static_cast<float>(settings.bins.side())) {}

  /// Calls `link(a, b)` for every pair below this one, and for this one itself if it needs no split.
  template <class Link>
  void walk(const Pair& pair, const Link& link) const {
    step(pair, link, [&](const Pair& next) { walk(next, link); });
  }

  /// The pairs of the first steps in a fixed order, to be walked in parallel; `link` as above.
  template <class Link>
  std::vector<Pair> start(const Link& link) const {
    constexpr std::size_t kEnough = 2048;
    std::vector<Pair> pairs;
    if (tree_.root != kNoElement) pairs.emplace_back(tree_.root, tree_.root);
    while (!pairs.empty() && pairs.size() < kEnough) {
      std::vector<Pair> next;
      for (const Pair& pair : pairs) step(pair, link, [&](const Pair& below) { next.push_back(below); });
      pairs = std::move(next);
    }
    return pairs;
  }

 private:
  /// Links the pair, or splits it.
  template <class Link, class Next>
  void step(const Pair& pair, const Link& link, const Next& next) const {
    const auto [a, b] = pair;
    if (!(state_.area[a] > 0.0f && state_.area[b] > 0.0f)) return;
    const bool still = state_.still[a] && state_.still[b];
    if (moving_ && still) return;
    if (a == b) {
      forBoth(a, next);
      return;
    }
    // Moving and still objects share no group but the root. The walk over moving pairs covers such a pair.
    if (!moving_ && !still) return;
    const bool splitA = !tree_.isLeaf(a) && isLarge(a, b), splitB = !tree_.isLeaf(b) && isLarge(b, a);
    if (!splitA && !splitB) {
      link(a, b);
    } else if (!splitA) {
      for (const std::uint32_t child : tree_.childrenOf(b))
        if (child != kNoElement) next({a, child});
    } else {
      for (const std::uint32_t child : tree_.childrenOf(a)) {
        if (child == kNoElement) continue;
        if (splitB)
          for (const std::uint32_t other : tree_.childrenOf(b)) {
            if (other != kNoElement) next({child, other});
          }
        else
          next({child, b});
      }
    }
  }

  /// Pairs a node with itself: its children with themselves and with each other.
  template <class Next>
  void forBoth(std::uint32_t node, const Next& next) const {
    if (tree_.isLeaf(node)) return;
    const std::array<std::uint32_t, 4>& children = tree_.childrenOf(node);
    for (std::size_t i = 0; i < children.size(); ++i)
      for (std::size_t k = i; k < children.size(); ++k)
        if (children[k] != kNoElement) next({children[i], children[k]});
  }

  /// The solid angle of bins in a direction of any length, taken from a small piece of the face in the middle
  /// of a bin.
  float binSize(const glm::vec3& direction) const {
    const glm::vec3 size = glm::abs(direction);
    const float along = std::max({size.x, size.y, size.z});
    const glm::vec3 ratio = size / along;
    const float lengthSquared = glm::dot(ratio, ratio);
    float area = smallStep_ * smallStep_;
    if (even_) {  // the derivatives of the tangent; that of the largest component counts as 2 here
      const glm::vec3 stretch = 1.0f + ratio * ratio;
      area *= 0.5f * stretch.x * stretch.y * stretch.z;
    }
    return area / (lengthSquared * std::sqrt(lengthSquared));
  }

  /// Whether `node`, seen from the middle of `eye`, covers more bins than allowed, or encloses it. Discs
  /// count by A cos / r^2, as if their whole curvature faced the eye; groups by their bounding sphere.
  bool isLarge(std::uint32_t node, std::uint32_t eye) const {
    if (split_ == 0.0f) return true;
    const glm::vec3 direction = state_.position[node] - state_.position[eye];
    const float distanceSquared = glm::dot(direction, direction), reach = state_.reach[node];
    if (!(distanceSquared > reach * reach)) return true;
    const float most = split_ * binSize(direction);
    if (tree_.isGroup(node))
      return 2.0f * std::numbers::pi_v<float> * (1.0f - std::sqrt(1.0f - reach * reach / distanceSquared)) >
             most;
    const glm::vec3& normal = state_.normal[node];
    const float cosine = std::abs(glm::dot(normal, direction)) / std::sqrt(distanceSquared);
    const float bent = std::max(1.0f - glm::length(normal), 0.0f);
    return std::max(state_.area[node], reach * reach) * std::min(cosine + bent, 1.0f) >
           most * distanceSquared;
  }

  const ElementTree& tree_;
  const ElementState& state_;
  float split_;
  bool moving_, even_;
  float smallStep_;  ///< size of a bin in the middle of a face, as a ratio of components
};

/// Makes both walks over all pairs: the first steps on one thread, the rest in parallel.
template <class Link>
void walkAll(const PairWalk& walk, const Link& link) {
  const std::vector<Pair> pairs = walk.start(link);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, pairs.size(), 1), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) walk.walk(pairs[i], link);
  });
}

}  // namespace

ElementLists<std::uint32_t> findPartners(const ElementTree& tree, const ElementState& state,
                                         const PairSettings& settings, bool moving) {
  const PairWalk walk(tree, state, settings, moving);
  std::vector<std::atomic<std::uint32_t>> counts(tree.nodeCount);
  walkAll(walk, [&](std::uint32_t a, std::uint32_t b) {
    counts[a].fetch_add(1, std::memory_order_relaxed);
    counts[b].fetch_add(1, std::memory_order_relaxed);
  });
  ElementLists<std::uint32_t> partners;
  partners.first.reserve(tree.nodeCount + 1);
  for (std::uint32_t node = 0; node < tree.nodeCount; ++node)
    partners.first.push_back(partners.first.back() + counts[node]);
  requireRoom({"pairs", tree.leafCount, partners.first.back() * sizeof(std::uint32_t), settings.bins.side()},
              ofHost());
  partners.values.resize(partners.first.back());
  for (std::atomic<std::uint32_t>& count : counts) count = 0;
  walkAll(walk, [&](std::uint32_t a, std::uint32_t b) {
    partners.values[partners.first[a] + counts[a].fetch_add(1, std::memory_order_relaxed)] = b;
    partners.values[partners.first[b] + counts[b].fetch_add(1, std::memory_order_relaxed)] = a;
  });
  tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, tree.nodeCount), [&](const auto& range) {
    for (std::uint32_t node = range.begin(); node < range.end(); ++node)
      std::sort(partners.values.begin() + static_cast<std::ptrdiff_t>(partners.first[node]),
                partners.values.begin() + static_cast<std::ptrdiff_t>(partners.first[node + 1]));
  });
  return partners;
}

}  // namespace lumivox::implicit_visibility
