// Finds what an element sees in each bin of directions: the nearest disc (Dong et al. 2007, Sec. 3 and 4.2).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "../elements/element_tree.h"
#include "direction_bins.h"

namespace lumivox::implicit_visibility {

/// Which bins a disc takes. centre: those whose middle ray meets it. one: the bin of its middle, whatever its
/// size, as published.
enum class Fill { centre, one };

/// Nodes as eyes see them: the polygons or discs of leaves. An inner node consists of its leaves within a
/// disc (where it is flat) or a sphere around them.
class DiscTree {
 public:
  DiscTree(const ElementTree& tree, const ElementState& state);

  struct Node {
    glm::vec3 position{0.0f};
    float radius = 0.0f;         ///< m: of the disc or sphere, which holds a leaf's polygon
    glm::vec3 normal{0.0f};      ///< unit length; 0: a sphere
    float filledSquared = 0.0f;  ///< square of a radius without holes inside, m^2
    bool isSphere() const { return normal == glm::vec3(0.0f); }
  };
  bool isLeaf(std::uint32_t node) const { return tree_.isLeaf(node); }
  const Node& operator[](std::uint32_t node) const { return nodes_[node]; }
  /// Whether a point in a leaf's plane and within its radius lies in its outline. `away`: relative to its
  /// position.
  bool covers(std::uint32_t leaf, const glm::vec3& away) const;
  /// Distance from `eye` along a ray of unit length to a leaf of an inner node; infinity: it meets none.
  float distanceTo(std::uint32_t node, const glm::vec3& eye, const glm::vec3& ray) const;

 private:
  void outline(std::uint32_t leaf, std::span<const glm::vec3> corners);

  const ElementTree& tree_;
  std::vector<Node> nodes_;
  /// Sides of leaves that are polygons, indexed like ElementTree::firstCorner: xyz the outward normal in the
  /// leaf's plane, of unit length; w its distance from the leaf's position, m.
  std::vector<glm::vec4> sides_;
};

/// The nearest node in a bin. Ordered by distance, then by node, so that the result does not depend on the
/// order of visits.
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

/// Tables for quick access to bins, the same for all eyes.
class BinFinder {
 public:
  explicit BinFinder(const DirectionBins& bins);
  const DirectionBins& bins() const { return bins_; }
  const BinTable& table() const { return table_; }
  glm::vec3 centre(std::uint32_t bin) const { return glm::vec3(table_.bins[bin]); }
  /// The first line of bins whose middle is at or beyond this ratio of components; side() if there is none.
  int firstMiddle(float ratio) const;
  float middle(int line) const { return middles_[static_cast<std::size_t>(line)]; }

 private:
  DirectionBins bins_;
  BinTable table_;
  std::vector<float> middles_;
  std::vector<int> firstOfCell_;  ///< for equal cells of the ratios -1 to 1
};

/// The bins of one eye; reused for the next.
class Eye {
 public:
  /// `cutsNearby`: an eye on a plane does not see nearby discs whose middle lies below it and that only stick
  /// out above it. Discs reach over the edges of their elements, and a convex edge would shade its own
  /// surface.
  Eye(const BinFinder& finder, const DiscTree& discs, bool cutsNearby);

  /// Empties all bins. An eye on a plane (a leaf) sees what reaches above its plane on either side; one
  /// without normal (an inner node) sees everything.
  void open(const glm::vec3& position, const glm::vec3& normal);
  /// Enters a node, unless it is at the eye's place.
  void see(std::uint32_t node, Fill fill);
  void see(const BinnedSight& seen) { offer(seen.bin, seen.sight); }
  /// Appends what is seen, by increasing bins.
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
  /// Distance along the middle ray of a bin to the node; infinity: it misses.
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
