// The nodes of the octree as printed: which there are, how they hang together, and the room that they take.
#include <algorithm>
#include <random>

#include "support/thesis_cone_tracing.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::thesis;
using octree::nodesWith;
using octree::shell;

namespace {

constexpr std::uint32_t kNone = ~0u;

/// Mirror of OctreeNode in shaders/thesis_cone_tracing/octree.glsl.
struct NodeData {
  std::uint32_t children, brick;
  std::array<std::uint32_t, 3> neighbours;
};

/// Bricks wanted and tiles wanted.
std::array<std::uint32_t, 2> wantedOf(const OctreeNodes& tree) {
  const auto words = tree.levels->downloadValues<std::uint32_t>();
  return {words.at(0), words.at(1)};
}

/// The node that is found from the root at a place of a level; kNone: none.
std::uint32_t nodeAt(const std::vector<NodeData>& nodes, const OctreeNodes& tree, int level,
                     const glm::ivec3& place) {
  std::uint32_t node = 0;
  for (int below = tree.depth - level - 1; below >= 0; --below) {
    if (nodes.at(node).children == kNone) return kNone;
    node = nodes.at(node).children + static_cast<std::uint32_t>((place.x >> below & 1) |
                                                                (place.y >> below & 1) << 1 |
                                                                (place.z >> below & 1) << 2);
  }
  return nodes.at(node).brick == kNone ? kNone : node;
}

std::set<Cell> nodesOf(const OctreeNodes& tree, int level) {
  std::set<Cell> result;
  for (const OctreeNodes::Brick& brick : tree.bricksOf(level)) result.insert(cellOf(brick.place));
  return result;
}

/// Coarse voxels at corners to which these add: those of the next level within one voxel of twice their
/// number.
std::set<Cell> coarserAtCorners(const std::set<Cell>& voxels) {
  std::set<Cell> coarse;
  for (const Cell& cell : voxels)
    for (int step = 0; step < 27; ++step) {
      const Cell shifted{cell[0] + step % 3 - 1, cell[1] + step / 3 % 3 - 1, cell[2] + step / 9 - 1};
      if (std::all_of(shifted.begin(), shifted.end(), [](int i) { return i % 2 == 0; }))
        coarse.insert({shifted[0] / 2, shifted[1] / 2, shifted[2] / 2});
    }
  return coarse;
}

}  // namespace

TEST_CASE("every level has the nodes whose bricks show something, and no others") {
  for (const glm::ivec3& size : {glm::ivec3(2), {8, 8, 8}, {11, 7, 5}, {64, 64, 64}, {65, 20, 33}}) {
    const std::vector<FragmentData> fragments = shell(size);
    const VoxelFragments list = listOf(fragments, size);
    for (const bool atCorners : {false, true}) {
      const OctreeNodes tree = treeOf(list, atCorners ? "at_corners" : "in_leaves");
      CAPTURE(atCorners, size.x, size.y, size.z, tree.depth);
      const int longest = std::max({size.x, size.y, size.z});
      REQUIRE((2 << tree.depth) >= longest);
      if (tree.depth > 0) REQUIRE((1 << tree.depth) < longest);
      std::set<Cell> voxels = cellsOf(fragments);
      std::size_t bricks = 0, inner = 0;
      for (int level = 0; level <= tree.depth; ++level) {
        std::set<Cell> expected;
        if (atCorners) {
          expected = nodesWith(voxels, 1 << (tree.depth - level));
          voxels = coarserAtCorners(voxels);
        } else {
          for (const Cell& cell : cellsOf(fragments))
            expected.insert({cell[0] >> (level + 1), cell[1] >> (level + 1), cell[2] >> (level + 1)});
        }
        CAPTURE(level);
        CHECK(nodesOf(tree, level) == expected);
        bricks += expected.size();
        if (level > 0) inner += expected.size();
      }
      // Not one more than there are; the root's tile, and one behind every node above the leaves.
      CHECK(tree.brickRoom == std::max<std::size_t>(bricks, 1));
      CHECK(tree.leafRoom == std::max<std::size_t>(nodesOf(tree, 0).size(), 1));
      CHECK(wantedOf(tree) == std::array<std::uint32_t, 2>{static_cast<std::uint32_t>(bricks),
                                                           static_cast<std::uint32_t>(inner + 1)});
    }
  }
}

TEST_CASE("every node is found from the root and knows its brick and its neighbours; others are not found") {
  const glm::ivec3 size(40, 24, 33);
  for (const char* voxels : {"in_leaves", "at_corners"}) {
    const OctreeNodes tree = treeOf(listOf(shell(size), size), voxels);
    std::vector<NodeData> nodes = tree.nodes->downloadValues<NodeData>();
    CHECK(nodes.size() == 8u * wantedOf(tree)[1]);
    for (int level = 0; level <= tree.depth; ++level) {
      std::map<Cell, std::uint32_t> expected;
      for (const OctreeNodes::Brick& brick : tree.bricksOf(level))
        expected[cellOf(brick.place)] = brick.index;
      const int along = 1 << (tree.depth - level);
      std::size_t found = 0, wrong = 0;
      for (int z = 0; z < along; ++z)
        for (int y = 0; y < along; ++y)
          for (int x = 0; x < along; ++x) {
            const std::uint32_t node = nodeAt(nodes, tree, level, {x, y, z});
            const auto known = expected.find({x, y, z});
            wrong += (node == kNone) != (known == expected.end()) ? 1u : 0u;
            if (node == kNone || known == expected.end()) continue;
            ++found;
            wrong += nodes[node].brick != known->second ? 1u : 0u;
            for (std::size_t axis = 0; axis < 3; ++axis) {
              glm::ivec3 next(x, y, z);
              ++next[static_cast<int>(axis)];
              const std::uint32_t neighbour =
                  next[static_cast<int>(axis)] < along ? nodeAt(nodes, tree, level, next) : kNone;
              wrong += nodes[node].neighbours[axis] != neighbour ? 1u : 0u;
            }
          }
      CAPTURE(voxels, level);
      CHECK(found == expected.size());
      CHECK(wrong == 0);
    }
  }
}

TEST_CASE("a list without fragments gives a tree without bricks") {
  const OctreeNodes tree = treeOf(listOf({}, glm::ivec3(16)));
  CHECK(wantedOf(tree) == std::array<std::uint32_t, 2>{0, 1});
  for (int level = 0; level <= tree.depth; ++level) CHECK(nodesOf(tree, level).empty());
}

TEST_CASE("a tree that outgrows its room is made again with all of it, and a smaller one keeps the room") {
  const glm::ivec3 size(32);
  const Scene scene = cones::emptyScene();
  PassHarness octree = passOf("octree", scene);
  const auto made = [&](const std::vector<FragmentData>& fragments) {
    octree.setInput("fragments", listOf(fragments, size));
    octree.run();
    return octree.output<OctreeNodes>("tree");
  };
  const std::vector<FragmentData> few{fragmentAt({3, 5, 9})};
  const std::uint64_t small = made(few).brickRoom, large = made(shell(size)).brickRoom;
  CHECK(small < large);
  const OctreeNodes again = made(few);
  CHECK(again.brickRoom == large);
  CHECK(wantedOf(again)[0] == small);
}

TEST_CASE("a tree that does not fit is refused") {
  gpu::DeviceOptions options;
  options.memoryBytes = 1500u << 10;
  gpu::Device small(options);
  const glm::ivec3 size(128);
  const Scene scene = cones::emptyScene();
  PassHarness octree(small, techniques(), "thesis_cone_tracing", "octree", scene, snapshotOf(scene, 0.0));
  octree.setInput("fragments", listOf(shell(glm::ivec3(32)), size, small));
  CHECK_NOTHROW(octree.run());
  octree.setInput("fragments", listOf(shell(size), size, small));
  CHECK_THROWS_WITH(octree.run(), Catch::Matchers::Contains("octree nodes"));
}
