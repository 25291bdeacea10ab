// Makes links among elements (Dong et al. 2007, Sec. 4.2; steps 5 to 7 of Algorithm 1).
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <span>
#include <utility>

#include "../passes.h"
#include "../room.h"
#include "looking.h"
#include "lumivox/base/log.h"
#include "pairs.h"

namespace lumivox::implicit_visibility {
namespace {

/// hierarchy: pairs of nodes as large as a bin. all_pairs: every leaf with every other one (Sec. 3.1).
enum class Method { hierarchy, allPairs };

/// On the host links exist twice while lists are joined and once more for still geometry; besides, the device
/// holds them.
void requireRoomForLinks(PassContext& frame, const ElementTree& tree, const DirectionBins& bins) {
  const std::uint64_t bytes =
      (frame.traits().movingGeometry ? 3 : 2) * sizeof(BinnedSight) + sizeof(ElementLink);
  requireRoom({"links", tree.leafCount, tree.leafCount * std::uint64_t{bins.count()} * bytes, bins.side()},
              ofHost());
}

void requireRoomOnDevice(PassContext& frame, const ElementTree& tree, int bins, std::uint64_t links) {
  requireRoom({"links", tree.leafCount, links * sizeof(ElementLink), bins},
              {"a buffer of the device", frame.device().info().maxStorageBytes});
}

class CreateLinksPass : public Pass {
  In<SurfaceElements> elements{this, "elements", "what is linked"};
  Param<Method> method{
      this, "method", Method::hierarchy,
      "hierarchy: pairs of nodes, split until they are as small as a bin; all_pairs: every element with "
      "every other one"};
  Param<int> bins{this, "bins", 8, within(1, 64), "bins along a side of a face of the cube of directions"};
  Param<BinMapping> mapping{this, "mapping", BinMapping::even,
                            "even: bins of nearly equal solid angles; uniform: equal steps on the face",
                            published(BinMapping::uniform)};
  // Which surface a bin holds is told by leaves, whatever the node: 2 costs 0.4 to 0.9 % of the light, and
  // less time.
  Param<float> split{
      this,
      "split",
      2.0f,
      within(0.0f, 64.0f),
      "number of bins that a node may cover before it is split; 0: all nodes are split, down to the leaves",
      published(1.0f)};
  Out<ElementLinks> result{this, "links", "pairs of nodes that may exchange light"};

  bool worksOnHost() const override { return true; }

  void run(PassContext& frame) override {
    ElementLinks links;
    links.bins = bins;
    links.mapping = mapping;
    const ElementTree& tree = *elements->tree;
    // Finding the pairs takes minutes, so the memory of links is checked first.
    requireRoomForLinks(frame, tree, DirectionBins(bins, links.mapping));
    if (method == Method::hierarchy) {
      const PairSettings settings{DirectionBins(bins, links.mapping), split};
      const auto find = [&](bool moving) {
        return std::make_shared<const ElementLists<std::uint32_t>>(
            findPartners(tree, *elements->state, settings, moving));
      };
      links.stillPartners =
          frame.kept("links among elements that stand still", elements->tree, [&] { return find(false); });
      links.movingPartners = find(true);
      logDetails("links: {} among nodes that stand still, {} of nodes that move",
                 links.stillPartners->values.size() / 2, links.movingPartners->values.size() / 2);
    }
    result = links;
  }
};

/// The bins that one side of an element sees. The element is in a closed room if every quarter of a face of
/// the cube that lies wholly above its plane has a link.
class Enclosure {
 public:
  Enclosure(const BinFinder& finder, const glm::vec3& normal, std::span<const ElementLink> seen) {
    const auto side = static_cast<std::uint32_t>(finder.bins().side());
    auto link = seen.begin();
    for (std::uint32_t bin = 0; bin < finder.bins().count(); ++bin) {
      const std::uint32_t row = bin / side % side, column = bin % side;
      Part& quarter = quarters_[4 * (bin / (side * side)) + 2 * (2 * row / side) + 2 * column / side];
      const bool isFilled = link != seen.end() && link->bin() == bin;
      if (isFilled) ++link;
      const bool isAbove = glm::dot(normal, finder.centre(bin)) > 0.0f;
      for (Part* part : {&quarter, &all_})
        ++part->bins, part->above += isAbove, part->filled += isAbove && isFilled;
    }
  }
  bool isClosed() const {
    return all_.filled > 0 && std::all_of(quarters_.begin(), quarters_.end(), [](const Part& quarter) {
             return quarter.above < quarter.bins || quarter.bins == 0 || quarter.filled > 0;
           });
  }
  std::uint32_t bins() const { return all_.above; }
  std::uint32_t empty() const { return all_.above - all_.filled; }

 private:
  struct Part {
    std::uint32_t bins = 0, above = 0,
                  filled = 0;  ///< above: bins above the element's plane; filled: those of them with a link
  };
  std::array<Part, 24> quarters_;
  Part all_;
};

class PushLinksPass : public Pass {
  In<SurfaceElements> elements{this, "elements", "what is linked"};
  In<ElementLinks> pairs{this, "links", "pairs of nodes, of create_links"};
  Param<Fill> fill{
      this, "fill", Fill::centre,
      "bins that an element fills; centre: those whose central ray hits its outline; one: the bin of its centre",
      published(Fill::one)};
  Param<Push> push{
      this, "push", Push::rebinned,
      "bin and distance of a link inherited from an inner node; rebinned: as seen from the leaf; kept: as seen from the inner node",
      published(Push::kept)};
  Out<ElementLinks> result{this, "links", "what each leaf sees, bin by bin"};

  bool worksOnHost() const override { return true; }

  void run(PassContext& frame) override {
    const ElementTree& tree = *elements->tree;
    const DirectionBins bins(pairs->bins, pairs->mapping);
    requireRoomForLinks(frame, tree, bins);
    const auto finder =
        frame.kept("table of bins", 0, [&] { return std::make_shared<const BinFinder>(bins); });
    const Lookout lookout(tree, *elements->state, *finder, fill, push);
    // A number that is clearly too large is refused before the search, which takes minutes.
    constexpr std::uint32_t kMany = 16384;
    if (tree.leafCount > kMany) {
      const std::uint64_t expected = lookout.estimate({pairs->stillPartners.get(), false});
      if (expected / 2 * sizeof(ElementLink) > frame.device().info().maxStorageBytes)
        requireRoomOnDevice(frame, tree, pairs->bins, expected);
    }
    using Lists = ElementLists<BinnedSight>;
    const std::shared_ptr<const Lists> still = frame.kept(
        "what elements see of what stands still", std::pair(elements->tree, pairs->stillPartners), [&] {
          return std::make_shared<const Lists>(lookout.look({pairs->stillPartners.get(), false}, nullptr));
        });
    const bool moves = frame.traits().movingGeometry;
    const Lists all = moves ? lookout.look({pairs->movingPartners.get(), true}, still.get()) : Lists();
    ElementLinks links = *pairs;
    upload(frame, moves ? all : *still, *finder, links);
    result = links;
    if (frame.inspects()) noteEmpty(frame, *finder, *links.seen);
  }

  void upload(PassContext& frame, const ElementLists<BinnedSight>& seen, const BinFinder& finder,
              ElementLinks& links) const {
    const ElementTree& tree = *elements->tree;
    requireRoomOnDevice(frame, tree, links.bins, seen.values.size());
    auto compact = std::make_shared<ElementLists<ElementLink>>(compactLinks(seen));
    std::vector<glm::uvec4> first;
    for (std::uint32_t leaf = 0; leaf < tree.leafCount; ++leaf)
      first.emplace_back(
          static_cast<std::uint32_t>(compact->first[leaf]),
          static_cast<std::uint32_t>(compact->first[leaf + 1] - compact->first[leaf]),
          std::bit_cast<std::uint32_t>(finder.table().projectionScale(elements->state->normal[leaf])), 0u);
    links.directions = frame.uploaded(finder.table().bins, "directions of bins");
    links.first = frame.uploaded(first, "where links of elements begin");
    links.links = frame.uploaded(compact->values, "links of elements");
    if (elements->emission != nullptr) uploadLights(frame, *compact, links);
    links.seen = std::move(compact);
  }

  /// Adds the sides that are seen. Nodes at the same place exchange no light.
  ElementLists<ElementLink> compactLinks(const ElementLists<BinnedSight>& seen) const {
    const ElementState& state = *elements->state;
    ElementLists<ElementLink> compact;
    compact.values.reserve(seen.values.size());
    for (std::uint32_t leaf = 0; leaf < seen.size(); ++leaf) {
      for (const BinnedSight& link : seen[leaf]) {
        const std::uint32_t node = link.sight.node;
        const glm::vec3 path = state.position[node] - state.position[leaf];
        if (path == glm::vec3(0.0f)) continue;
        const bool back = !elements->tree->isGroup(node) && glm::dot(state.normal[node], path) > 0.0f;
        compact.values.emplace_back(link.bin, link.sight.distance, node, back);
      }
      compact.first.push_back(compact.values.size());
    }
    return compact;
  }

  /// For each leaf its links to nodes that emit.
  void uploadLights(PassContext& frame, const ElementLists<ElementLink>& seen, ElementLinks& links) const {
    std::vector<std::uint32_t> words(2 * seen.size());
    for (std::size_t leaf = 0; leaf < seen.size(); ++leaf) {
      words[2 * leaf] = static_cast<std::uint32_t>(words.size());
      for (std::uint64_t i = seen.first[leaf]; i < seen.first[leaf + 1]; ++i)
        if (elements->tree->emits[seen.values[i].node]) words.push_back(static_cast<std::uint32_t>(i));
      words[2 * leaf + 1] = static_cast<std::uint32_t>(words.size()) - words[2 * leaf];
    }
    links.lights = frame.uploaded(words, "links of elements to lights");
  }

  void noteEmpty(PassContext& frame, const BinFinder& finder, const ElementLists<ElementLink>& seen) const {
    const std::vector<glm::vec3>& normals = elements->state->normal;
    std::uint64_t empty = 0, all = 0;
    for (std::uint32_t leaf = 0; leaf < seen.size(); ++leaf)
      for (const float side : {1.0f, -1.0f}) {
        const Enclosure enclosure(finder, side * normals[leaf], seen[leaf]);
        if (!enclosure.isClosed()) continue;
        empty += enclosure.empty();
        all += enclosure.bins();
      }
    if (all > 0)
      frame.note(fmt::format("{:.1f} % of the bins of elements in closed rooms hold no link",
                             100.0 * static_cast<double>(empty) / static_cast<double>(all)));
  }
};

}  // namespace

void addLinks(TechniqueRegistry& registry) {
  registry.add<CreateLinksPass>("create_links",
                                "Pairs of elements that may exchange light (Dong et al. 2007, Sec. 4.2.2)");
  registry.add<PushLinksPass>(
      "push_links", "The nearest element in each bin of each leaf (Dong et al. 2007, Sec. 4.2.3, 4.2.4)");
}

}  // namespace lumivox::implicit_visibility
