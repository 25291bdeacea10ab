// What an element sees in each bin of directions: the nearest disc (Dong et al. 2007, Sec. 3 and 4.2).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "../elements/element_tree.h"
#include "direction_bins.h"

namespace lumivox::implicit_visibility {

/// Which bins a disc takes. centre: those whose middle ray meets it. one: that of its middle, whatever its
/// size, as published.
enum class Fill { centre, one };

/// Nodes as they are seen: the polygons or discs of leaves. An inner node is what its leaves are, in a disc
/// (where it is flat) or a sphere around all of them.
class DiscTree {
 public:
  DiscTree(const ElementTree& tree, const ElementState& state);

  struct Node {
    glm::vec3 position{0.0f};
    float radius = 0.0f;         ///< m: of the disc or sphere, which holds a leaf's polygon
    glm::vec3 normal{0.0f};      ///< unit length; 0: a sphere
    float filledSquared = 0.0f;  ///< m^2: square of a radius within which there is no hole
    bool isSphere() const { return normal == glm::vec3(0.0f); }
  };
  bool isLeaf(std::uint32_t node) const { return tree_.isLeaf(node); }
  const Node& operator[](std::uint32_t node) const { return nodes_[node]; }
  /// Whether a point in the plane of a leaf, within its radius, lies in its outline. `away`: from its
  /// position.
  bool covers(std::uint32_t leaf, const glm::vec3& away) const;
  /// How far a ray of unit length from `eye` goes until it meets a leaf of an inner node; infinity: it meets
  /// none.
  float distanceTo(std::uint32_t node, const glm::vec3& eye, const glm::vec3& ray) const;

 private:
  void outline(std::uint32_t leaf, std::span<const glm::vec3> corners);

  const ElementTree& tree_;
  std::vector<Node> nodes_;
  /// Of the sides of leaves that are polygons, as ElementTree::firstCorner: xyz the way out, of unit length
  /// in the leaf's plane; w its distance from the leaf's position, m.
  std::vector<glm::vec4> sides_;
};

/// What is nearest in a bin. Ordered by distance, then by node, so that the nearest of many does not depend
/// on the order in which they come.
struct Sight {
  float distance;
  std::uint32_t node;
  bool nearerThan(const Sight& other) const {
    return distance < other.distance || (distance == other.distance && node < other.node);
  }
  bool operator==(const Sight&) const = default;
};
struct BinnedSight {
  std::uint32_t bin;
  Sight sight;
  bool operator==(const BinnedSight&) const = default;
};

/// Bins with tables for quick access, the same for all eyes.
class BinFinder {
 public:
  explicit BinFinder(const DirectionBins& bins);
  const DirectionBins& bins() const { return bins_; }
  const BinTable& table() const { return table_; }
  glm::vec3 centre(std::uint32_t bin) const { return glm::vec3(table_.bins[bin]); }
  /// The first line of bins whose middle is at this ratio of components or beyond; side() when there is none.
  int firstMiddle(float ratio) const;
  float middle(int line) const { return middles_[static_cast<std::size_t>(line)]; }

 private:
  DirectionBins bins_;
  BinTable table_;
  std::vector<float> middles_;
  std::vector<int> firstOfCell_;  ///< of even cells of the ratios -1 to 1
};

/// The bins of one eye after another.
class Eye {
 public:
  /// `cutsNearby`: an eye on a plane does not see what only sticks out above it of discs near by, whose
  /// middle is below it: discs reach over the edges of their elements, and a convex edge would shade its own
  /// surface.
  Eye(const BinFinder& finder, const DiscTree& discs, bool cutsNearby);

  /// Empties all bins. An eye on a plane (a leaf) sees in the bins of a side what reaches above its plane
  /// there, and one without normal (an inner node) in all.
  void open(const glm::vec3& position, const glm::vec3& normal);
  /// A disc: what is at the eye's place is not seen.
  void see(std::uint32_t node, Fill fill);
  void see(const BinnedSight& seen) { offer(seen.bin, seen.sight); }
  /// By growing bins.
  void collect(std::vector<BinnedSight>& seen) const;

 private:
  /// A node relative to the eye.
  struct Seen {
    const DiscTree::Node& disc;
    std::uint32_t node;
    glm::vec3 direction{0.0f}, normal{0.0f};  ///< normal: of a disc that hides the node, seen from here
    float distance = 0.0f, radius = 0.0f;     ///< radius: of that disc
    bool front = true, back = true;           ///< whether some of it is above the plane on these sides
  };
  void rasterise(const Seen& seen);
  void rasteriseFace(const Seen& seen, int axis, float side);
  /// How far the middle ray of a bin goes until it meets the node; infinity: it does not.
  float meet(const Seen& seen, const glm::vec3& ray, float nearest) const;
  void offer(std::uint32_t bin, const Sight& sight);

  const BinFinder& finder_;
  const DiscTree& discs_;
  bool cutsNearby_;
  glm::vec3 position_{0.0f}, normal_{0.0f};
  bool hasPlane_ = false;
  std::vector<Sight> nearest_;
};

}  // namespace lumivox::implicit_visibility
