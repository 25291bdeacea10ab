#include "looking.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>

namespace lumivox::implicit_visibility {

/// Calls look(eye, i) for all i < count and gathers what the eyes see. Each thread has an eye.
template <class Look>
ElementLists<BinnedSight> Lookout::collect(std::uint32_t count, const Look& look) const {
  constexpr std::uint32_t kBlock = 32;
  struct Block {
    std::vector<BinnedSight> seen;
    std::vector<std::uint32_t> counts;
  };
  std::vector<Block> blocks((count + kBlock - 1) / kBlock);
  // As published nothing is cut, since bins of inner nodes, or single bins, have to fill the gaps.
  const bool cutsNearby = fill_ == Fill::centre && push_ == Push::rebinned;
  tbb::enumerable_thread_specific<Eye> eyes([&] { return Eye(finder_, discs_, cutsNearby); });
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blocks.size(), 1), [&](const auto& range) {
    Eye& eye = eyes.local();
    for (std::size_t b = range.begin(); b < range.end(); ++b) {
      const std::uint32_t first = static_cast<std::uint32_t>(b) * kBlock;
      for (std::uint32_t i = first; i < std::min(first + kBlock, count); ++i) {
        const std::size_t before = blocks[b].seen.size();
        look(eye, i);
        eye.collect(blocks[b].seen);
        blocks[b].counts.push_back(static_cast<std::uint32_t>(blocks[b].seen.size() - before));
      }
    }
  });
  ElementLists<BinnedSight> lists;
  lists.first.reserve(count + 1);
  for (const Block& block : blocks)
    for (const std::uint32_t length : block.counts) lists.first.push_back(lists.first.back() + length);
  lists.values.reserve(lists.first.back());
  for (Block& block : blocks) {
    lists.values.insert(lists.values.end(), block.seen.begin(), block.seen.end());
    block = {};
  }
  return lists;
}

ElementLists<BinnedSight> Lookout::lookFromInner(const Partners& partners) const {
  return collect(tree_.nodeCount - tree_.leafCount, [&](Eye& eye, std::uint32_t i) {
    const std::uint32_t node = tree_.leafCount + i;
    eye.open(state_.position[node], glm::vec3(0.0f));
    for (const std::uint32_t partner : (*partners.lists)[node]) eye.see(partner, fill_);
  });
}

void Lookout::seeAllLeaves(Eye& eye, std::uint32_t leaf, bool moving) const {
  for (std::uint32_t other = 0; other < tree_.leafCount; ++other)
    if (other != leaf && moving != (state_.still[leaf] && state_.still[other])) eye.see(other, fill_);
}

void Lookout::lookFrom(Eye& eye, std::uint32_t leaf, const Partners& partners,
                       const ElementLists<BinnedSight>& inner) const {
  if (partners.lists == nullptr) {
    seeAllLeaves(eye, leaf, partners.moving);
    return;
  }
  for (const std::uint32_t partner : (*partners.lists)[leaf]) eye.see(partner, fill_);
  for (std::uint32_t node = tree_.parents[leaf]; node != kNoElement; node = tree_.parents[node])
    if (push_ == Push::kept)
      for (const BinnedSight& seen : inner[node - tree_.leafCount]) eye.see(seen);
    else
      for (const std::uint32_t partner : (*partners.lists)[node]) eye.see(partner, fill_);
}

std::uint64_t Lookout::estimate(const Partners& partners) const {
  constexpr std::uint32_t kLeaves = 256;
  const std::uint32_t count = std::min(tree_.leafCount, kLeaves);
  if (count == 0 || (push_ == Push::kept && partners.lists != nullptr)) return 0;
  const ElementLists<BinnedSight> some = collect(count, [&](Eye& eye, std::uint32_t i) {
    const auto leaf = static_cast<std::uint32_t>(std::uint64_t{i} * tree_.leafCount / count);
    eye.open(state_.position[leaf], state_.normal[leaf]);
    if (state_.area[leaf] > 0.0f) lookFrom(eye, leaf, partners, {});
  });
  return some.values.size() * std::uint64_t{tree_.leafCount} / count;
}

ElementLists<BinnedSight> Lookout::look(const Partners& partners,
                                        const ElementLists<BinnedSight>* before) const {
  ElementLists<BinnedSight> inner;
  if (push_ == Push::kept && partners.lists != nullptr) inner = lookFromInner(partners);
  return collect(tree_.leafCount, [&](Eye& eye, std::uint32_t leaf) {
    eye.open(state_.position[leaf], state_.normal[leaf]);
    if (!(state_.area[leaf] > 0.0f)) return;
    if (before != nullptr)
      for (const BinnedSight& seen : (*before)[leaf]) eye.see(seen);
    lookFrom(eye, leaf, partners, inner);
  });
}

}  // namespace lumivox::implicit_visibility
