// Trees of surface elements (Dong, Kautz, Theobalt and Seidel 2007, Sec. 4.1): quadtrees of discs over the
// segments of a surface, and groups of four above the segments. Parents and children follow from the numbers
// of nodes alone.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace lumivox::implicit_visibility {

inline constexpr std::uint32_t kNoElement = 0xffffffffu;

/// A quadtree over a row of leaves: node i of level l covers the leaves 4^l i .. 4^l (i+1) - 1, as far as
/// there are any. Its nodes are numbered leaves first, then level by level; the root is the last: with 16
/// leaves these are 0-15, the next level 16-19, the root 20.
class QuadtreeNumbers {
 public:
  explicit QuadtreeNumbers(std::uint32_t leaves);
  std::uint32_t nodeCount() const { return first_.back(); }
  std::uint32_t levelCount() const { return static_cast<std::uint32_t>(first_.size()) - 1; }
  /// The first node of a level; of level levelCount(): nodeCount().
  std::uint32_t levelFirst(std::uint32_t level) const { return first_[level]; }
  std::uint32_t levelSize(std::uint32_t level) const { return first_[level + 1] - first_[level]; }
  std::uint32_t levelOf(std::uint32_t node) const;
  std::uint32_t parent(std::uint32_t node) const;      ///< kNoElement for the root
  std::uint32_t firstChild(std::uint32_t node) const;  ///< kNoElement for a leaf
  std::uint32_t childCount(std::uint32_t node) const;  ///< 0 for a leaf, else 1 to 4

 private:
  std::vector<std::uint32_t> first_;  ///< of each level, and one more
};

/// All nodes of a scene in one row: the leaves of all segments, segment after segment; the nodes of level 1
/// of all segments, of level 2, and so on; then groups, which have up to four roots of segments or other
/// groups as children. Every node comes behind its children. The tree is made of the scene at rest and never
/// changes.
struct ElementTree {
  struct Segment {
    std::uint32_t object = 0;  ///< index into Scene::objects
    std::uint32_t firstLeaf = 0, leafCount = 0;
    std::uint32_t root = 0;  ///< its node
    bool operator==(const Segment&) const = default;
  };
  struct Run {
    std::uint32_t first = 0, count = 0;  ///< nodes
    bool operator==(const Run&) const = default;
  };
  std::vector<Segment> segments;
  std::uint32_t leafCount = 0;   ///< nodes 0 .. leafCount - 1
  std::uint32_t firstGroup = 0;  ///< nodes from here on are groups, those before are discs
  std::uint32_t nodeCount = 0;
  /// The leaves, then runs of nodes whose children all lie in earlier runs. Pull-up follows this order.
  std::vector<Run> levels;
  std::vector<std::array<std::uint32_t, 4>>
      children;                        ///< of node leafCount + i; kNoElement where there are fewer
  std::vector<std::uint32_t> parents;  ///< of each node; kNoElement for those without
  std::vector<std::uint32_t> segmentOfLeaf;
  /// Where leaves stand on vertices, the leaf of each of Scene::positions (kNoElement: none); else empty.
  std::vector<std::uint32_t> leafOfVertex;
  /// Of each leaf, where its corners begin in ElementState::corners, and one more; empty where leaves are
  /// discs.
  std::vector<std::uint32_t> firstCorner;
  std::vector<bool> emits;                  ///< of each node: whether a leaf of it shines
  std::vector<bool> glossy;                 ///< of each node: whether a leaf of it is glossy
  std::vector<std::uint32_t> objectOfNode;  ///< index into Scene::objects; kNoElement: a group of several
  std::uint32_t root = kNoElement;          ///< of everything; kNoElement without a leaf

  bool isLeaf(std::uint32_t node) const { return node < leafCount; }
  bool isGroup(std::uint32_t node) const { return node >= firstGroup; }
  const std::array<std::uint32_t, 4>& childrenOf(std::uint32_t node) const {
    return children[node - leafCount];
  }
};

/// Where the elements of a tree are at one moment, for each node. Positions are relative to
/// SceneSnapshot::origin.
struct ElementState {
  std::vector<glm::vec3> position;  ///< m: mean of the leaves by area
  std::vector<float> area;          ///< m^2: sum of the leaves
  /// Of discs: the mean of the leaves' normals by area, of unit length for leaves and shorter where a node is
  /// bent; zero without area. Of groups: the area that the leaves show along x, y and z, m^2.
  std::vector<glm::vec3> normal;
  /// m: of discs sqrt(area / 2), half the diagonal of a square of that area.
  std::vector<float> radius;
  std::vector<float> reach;  ///< m: the farthest point of a leaf from the node's position
  /// m: of leaves that are polygons (ElementTree::firstCorner), from their positions; convex and in the plane
  /// of the leaf's normal.
  std::vector<glm::vec3> corners;
  /// Whether the node's leaves stand where they stood at rest, whatever the time: objects without motion.
  std::vector<bool> still;

  /// Of a leaf; none: it is a disc of radius `reach`.
  std::span<const glm::vec3> outline(const ElementTree& tree, std::uint32_t leaf) const {
    if (tree.firstCorner.empty()) return {};
    return std::span(corners).subspan(tree.firstCorner[leaf],
                                      tree.firstCorner[leaf + 1] - tree.firstCorner[leaf]);
  }
};

}  // namespace lumivox::implicit_visibility
