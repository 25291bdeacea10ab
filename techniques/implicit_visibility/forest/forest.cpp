#include "forest.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

namespace lumivox::implicit_visibility {
namespace {

/// Bits of up to 16 coordinates each, one in turn.
std::uint64_t mortonCode(std::span<const std::uint32_t> coordinates) {
  std::uint64_t code = 0;
  for (std::uint32_t bit = 0; bit < 16; ++bit)
    for (std::size_t axis = 0; axis < coordinates.size(); ++axis)
      code |= std::uint64_t{coordinates[axis] >> bit & 1u} << (bit * coordinates.size() + axis);
  return code;
}

/// Places as whole numbers of 16 bits, by one step for all axes. Texels are whole numbers already and stay
/// so, so that four of them make a square.
template <class Place>
std::vector<std::uint64_t> mortonCodes(const std::vector<Place>& places) {
  constexpr double kMost = 65535.0;
  constexpr auto kAxes = static_cast<std::size_t>(Place::length());
  Place low(std::numeric_limits<double>::infinity()), high(-low);
  bool whole = true;
  for (const Place& place : places) {
    low = glm::min(low, place), high = glm::max(high, place);
    whole = whole && place == glm::floor(place);
  }
  double extent = 0.0;
  for (int axis = 0; axis < Place::length(); ++axis) extent = std::max(extent, high[axis] - low[axis]);
  const double scale = whole && extent <= kMost ? 1.0 : extent > 0.0 ? kMost / extent : 0.0;
  std::vector<std::uint64_t> codes;
  for (const Place& place : places) {
    std::array<std::uint32_t, kAxes> coordinates;
    for (std::size_t axis = 0; axis < kAxes; ++axis) {
      const int k = static_cast<int>(axis);
      coordinates[axis] = static_cast<std::uint32_t>((place[k] - low[k]) * scale);
    }
    codes.push_back(mortonCode(coordinates));
  }
  return codes;
}

std::vector<std::uint32_t> orderOf(const std::vector<std::uint64_t>& codes) {
  std::vector<std::uint32_t> order(codes.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return codes[a] < codes[b]; });
  return order;
}

/// Brings leaves into the order of the tree: by objects, segments (by their first leaf), and Morton order.
void sortLeaves(Origins& origins, ElementTree& tree) {
  std::vector<std::vector<std::uint32_t>> segments;
  std::vector<std::uint32_t> numbers;  // of Leaf::segment
  for (std::uint32_t i = 0; i < origins.leaves.size(); ++i) {
    const std::uint32_t segment = origins.leaves[i].segment;
    if (segment >= numbers.size()) numbers.resize(segment + 1, kNoElement);
    if (numbers[segment] == kNoElement) {
      numbers[segment] = static_cast<std::uint32_t>(segments.size());
      segments.emplace_back();
    }
    segments[numbers[segment]].push_back(i);
  }
  Origins sorted;
  sorted.withoutTexcoords = origins.withoutTexcoords;
  for (const std::vector<std::uint32_t>& members : segments) {
    std::vector<glm::dvec2> places;
    for (const std::uint32_t i : members) places.push_back(origins.leaves[i].place);
    tree.segments.push_back({origins.leaves[members.front()].object,
                             static_cast<std::uint32_t>(sorted.leaves.size()),
                             static_cast<std::uint32_t>(members.size()), 0});
    for (const std::uint32_t k : orderOf(mortonCodes(places))) {
      const std::uint32_t i = members[k];
      sorted.leaves.push_back(origins.leaves[i]);
      tree.segmentOfLeaf.push_back(static_cast<std::uint32_t>(tree.segments.size()) - 1);
      if (origins.firstTriangle.empty()) continue;
      sorted.firstTriangle.push_back(static_cast<std::uint32_t>(sorted.triangles.size()));
      sorted.triangles.insert(sorted.triangles.end(), origins.triangles.begin() + origins.firstTriangle[i],
                              origins.triangles.begin() + origins.firstTriangle[i + 1]);
    }
  }
  if (!origins.firstTriangle.empty())
    sorted.firstTriangle.push_back(static_cast<std::uint32_t>(sorted.triangles.size()));
  origins = std::move(sorted);
}

void countCorners(const Origins& origins, ElementTree& tree) {
  if (!origins.firstTriangle.empty()) return;
  tree.firstCorner.push_back(0);
  for (const Leaf& leaf : origins.leaves)
    tree.firstCorner.push_back(tree.firstCorner.back() + leaf.outline.count);
}

void findVertices(const Scene& scene, const Origins& origins, ElementTree& tree) {
  if (origins.firstTriangle.empty()) return;
  tree.leafOfVertex.assign(scene.positions.size(), kNoElement);
  for (std::uint32_t leaf = 0; leaf < origins.leaves.size(); ++leaf)
    tree.leafOfVertex[origins.leaves[leaf].vertex] = leaf;
}

/// Nodes of the segments above the leaves, level by level.
void addSegmentNodes(ElementTree& tree) {
  tree.leafCount = static_cast<std::uint32_t>(tree.segmentOfLeaf.size());
  tree.nodeCount = tree.leafCount;
  tree.levels.push_back({0, tree.leafCount});
  tree.parents.assign(tree.leafCount, kNoElement);
  for (const std::uint32_t segment : tree.segmentOfLeaf)
    tree.objectOfNode.push_back(tree.segments[segment].object);
  std::vector<QuadtreeNumbers> numbers;
  std::vector<std::uint32_t> below;  // of each segment: its first node on the level below
  for (ElementTree::Segment& segment : tree.segments) {
    numbers.emplace_back(segment.leafCount);
    below.push_back(segment.firstLeaf);
    segment.root = segment.firstLeaf;
  }
  for (std::uint32_t level = 1;; ++level) {
    const std::uint32_t first = tree.nodeCount;
    for (std::size_t s = 0; s < tree.segments.size(); ++s) {
      if (level >= numbers[s].levelCount()) continue;
      const std::uint32_t own = numbers[s].levelFirst(level), ownBelow = numbers[s].levelFirst(level - 1),
                          start = tree.nodeCount;
      for (std::uint32_t node = own; node < own + numbers[s].levelSize(level); ++node) {
        std::array<std::uint32_t, 4>& children = tree.children.emplace_back();
        children.fill(kNoElement);
        for (std::uint32_t k = 0; k < numbers[s].childCount(node); ++k) {
          children[k] = below[s] + numbers[s].firstChild(node) - ownBelow + k;
          tree.parents[children[k]] = tree.nodeCount;
        }
        tree.parents.push_back(kNoElement);
        tree.objectOfNode.push_back(tree.segments[s].object);
        ++tree.nodeCount;
      }
      tree.segments[s].root = tree.nodeCount - 1;
      below[s] = start;
    }
    if (tree.nodeCount == first) break;
    tree.levels.push_back({first, tree.nodeCount - first});
  }
  tree.firstGroup = tree.nodeCount;
}

/// Groups, a round at a time: up to four members that follow each other in Morton order of their places.
class GroupMaker {
 public:
  explicit GroupMaker(ElementTree& tree, std::vector<glm::dvec3> places)
      : tree_(tree), places_(std::move(places)) {}

  /// Each list of nodes becomes one node: of several lists at a time, so that a round is a run of the tree's
  /// levels.
  std::vector<std::uint32_t> join(std::vector<std::vector<std::uint32_t>> lists) {
    for (std::vector<std::uint32_t>& list : lists) sort(list);
    for (bool more = true; more;) {
      more = false;
      const std::uint32_t first = tree_.nodeCount;
      for (std::vector<std::uint32_t>& list : lists) {
        if (list.size() < 2) continue;
        std::vector<std::uint32_t> next;
        for (std::size_t i = 0; i < list.size(); i += 4)
          next.push_back(group(std::span(list).subspan(i, std::min<std::size_t>(4, list.size() - i))));
        list = std::move(next);
        more = more || list.size() > 1;
      }
      if (tree_.nodeCount > first) tree_.levels.push_back({first, tree_.nodeCount - first});
    }
    std::vector<std::uint32_t> roots;
    for (const std::vector<std::uint32_t>& list : lists)
      if (!list.empty()) roots.push_back(list.front());
    return roots;
  }

 private:
  void sort(std::vector<std::uint32_t>& list) const {
    std::vector<glm::dvec3> places;
    for (const std::uint32_t node : list) places.push_back(places_[node]);
    std::vector<std::uint32_t> sorted;
    for (const std::uint32_t k : orderOf(mortonCodes(places))) sorted.push_back(list[k]);
    list = std::move(sorted);
  }

  std::uint32_t group(std::span<const std::uint32_t> members) {
    if (members.size() == 1) return members.front();
    std::array<std::uint32_t, 4>& children = tree_.children.emplace_back();
    children.fill(kNoElement);
    glm::dvec3 place(0.0);
    std::uint32_t object = tree_.objectOfNode[members.front()];
    for (std::size_t k = 0; k < members.size(); ++k) {
      children[k] = members[k];
      tree_.parents[members[k]] = tree_.nodeCount;
      place += places_[members[k]] / static_cast<double>(members.size());
      if (tree_.objectOfNode[members[k]] != object) object = kNoElement;
    }
    places_.push_back(place);
    tree_.parents.push_back(kNoElement);
    tree_.objectOfNode.push_back(object);
    return tree_.nodeCount++;
  }

  ElementTree& tree_;
  std::vector<glm::dvec3> places_;  ///< at rest, m
};

glm::dvec3 restPlace(const Scene& scene, const Leaf& leaf) {
  const auto at = [&](std::uint32_t vertex) {
    return glm::dvec3(scene.objects[leaf.object].placement *
                      glm::dvec4(glm::dvec3(scene.positions[vertex]), 1.0));
  };
  if (leaf.vertex != kNoElement) return at(leaf.vertex);
  const double b = static_cast<double>(leaf.second), c = static_cast<double>(leaf.third);
  const std::uint32_t* corners = &scene.indices[3 * leaf.triangle];
  return (1.0 - b - c) * at(corners[0]) + b * at(corners[1]) + c * at(corners[2]);
}

/// Of a leaf's triangle, or of all triangles of its vertex, m^2.
float restArea(const Scene& scene, const Origins& origins, std::size_t leaf) {
  const glm::dmat3 placement(scene.objects[origins.leaves[leaf].object].placement);
  const auto areaOf = [&](std::uint32_t triangle) {
    const std::uint32_t* corners = &scene.indices[3 * triangle];
    const glm::dvec3 a(scene.positions[corners[0]]), b(scene.positions[corners[1]]),
        c(scene.positions[corners[2]]);
    return 0.5 * glm::length(glm::cross(placement * (b - a), placement * (c - a)));
  };
  if (origins.firstTriangle.empty()) return static_cast<float>(areaOf(origins.leaves[leaf].triangle));
  double area = 0.0;
  for (std::uint32_t i = origins.firstTriangle[leaf]; i < origins.firstTriangle[leaf + 1]; ++i)
    area += areaOf(origins.triangles[i]);
  return static_cast<float>(area);
}

void addGroups(const Scene& scene, const Origins& origins, ElementTree& tree) {
  std::vector<glm::dvec3> places;
  for (const Leaf& leaf : origins.leaves) places.push_back(restPlace(scene, leaf));
  for (std::uint32_t node = tree.leafCount; node < tree.nodeCount; ++node) {
    glm::dvec3 sum(0.0);
    double count = 0.0;
    for (const std::uint32_t child : tree.childrenOf(node))
      if (child != kNoElement) sum += places[child], count += 1.0;
    places.push_back(sum / count);
  }
  std::vector<std::vector<std::uint32_t>> ofObjects(scene.objects.size());
  for (const ElementTree::Segment& segment : tree.segments) ofObjects[segment.object].push_back(segment.root);
  GroupMaker groups(tree, std::move(places));
  std::vector<std::vector<std::uint32_t>> kinds(2);  // what stands still, and what moves
  for (const std::uint32_t root : groups.join(std::move(ofObjects)))
    kinds[scene.objects[tree.objectOfNode[root]].animated() ? 1 : 0].push_back(root);
  const std::vector<std::uint32_t> top = groups.join({groups.join(std::move(kinds))});
  if (!top.empty()) tree.root = top.front();
}

template <class Value>
std::vector<glm::vec4> pulledUp(const Origins& origins, const ElementTree& tree, Value&& value) {
  std::vector<glm::vec4> result;
  std::vector<double> areas;
  for (const Leaf& leaf : origins.leaves) {
    result.push_back(value(leaf));
    areas.push_back(static_cast<double>(leaf.area));
  }
  for (std::uint32_t node = tree.leafCount; node < tree.nodeCount; ++node) {
    glm::dvec4 sum(0.0);
    double area = 0.0;
    for (const std::uint32_t child : tree.childrenOf(node))
      if (child != kNoElement) sum += areas[child] * glm::dvec4(result[child]), area += areas[child];
    result.push_back(area > 0.0 && !tree.isGroup(node) ? glm::vec4(sum / area) : glm::vec4(0.0f));
    areas.push_back(area);
  }
  return result;
}

}  // namespace

Forest plantForest(const Scene& scene, Origins origins) {
  Forest forest;
  auto tree = std::make_shared<ElementTree>();
  sortLeaves(origins, *tree);
  findVertices(scene, origins, *tree);
  countCorners(origins, *tree);
  addSegmentNodes(*tree);
  addGroups(scene, origins, *tree);
  forest.albedo = pulledUp(origins, *tree, [](const Leaf& leaf) { return glm::vec4(leaf.albedo, 1.0f); });
  forest.specular = pulledUp(origins, *tree, [](const Leaf& leaf) { return leaf.specular; });
  forest.emission = pulledUp(origins, *tree, [](const Leaf& leaf) { return glm::vec4(leaf.emission, 0.0f); });
  for (const Leaf& leaf : origins.leaves) {
    tree->glossy.push_back(glm::vec3(leaf.specular) != glm::vec3(0.0f));
    tree->emits.push_back(leaf.emission != glm::vec3(0.0f));
    forest.glossy = forest.glossy || tree->glossy.back();
    forest.emissive = forest.emissive || tree->emits.back();
    forest.restTriangleArea.push_back(restArea(scene, origins, forest.restTriangleArea.size()));
  }
  for (std::uint32_t node = tree->leafCount; node < tree->nodeCount; ++node) {
    const std::array<std::uint32_t, 4>& children = tree->childrenOf(node);
    const auto any = [&](const std::vector<bool>& nodes) {
      return std::any_of(children.begin(), children.end(),
                         [&](std::uint32_t child) { return child != kNoElement && nodes[child]; });
    };
    tree->emits.push_back(any(tree->emits));
    tree->glossy.push_back(any(tree->glossy));
  }
  forest.origins = std::move(origins);
  forest.tree = std::move(tree);
  return forest;
}

}  // namespace lumivox::implicit_visibility
