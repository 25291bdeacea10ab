// The nodes of the sparse voxel octree: which there are, how they hang together, and the room that they take.
#include <algorithm>
#include <bit>
#include <random>

#include "support/octree.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::octree;

namespace {

/// Voxels of every level that are not empty: every voxel adds to that of half its number.
std::vector<std::set<Cell>> filledVoxels(const std::set<Cell>& finest, int levels) {
  std::vector<std::set<Cell>> result{finest};
  while (static_cast<int>(result.size()) < levels) {
    std::set<Cell> coarse;
    for (const Cell& cell : result.back()) coarse.insert({cell[0] / 2, cell[1] / 2, cell[2] / 2});
    result.push_back(coarse);
  }
  return result;
}

/// The nodes that these voxels are their own of.
std::set<Cell> ownersOf(const std::set<Cell>& voxels) {
  std::set<Cell> result;
  for (const Cell& voxel : voxels) result.insert({voxel[0] / 2, voxel[1] / 2, voxel[2] / 2});
  return result;
}

std::set<Cell> nodesOf(const VoxelOctree& tree, int level) {
  std::set<Cell> result;
  for (const auto& brick : OctreeBrickList::of(tree, level).bricks) result.insert(cellOf(brick.place));
  return result;
}

}  // namespace

TEST_CASE("bricks are there for what lies in them and no others, and each is known all around it") {
  for (const glm::ivec3& size : {glm::ivec3(2), {8, 8, 8}, {11, 7, 5}, {64, 64, 64}, {65, 20, 33}}) {
    const std::vector<FragmentData> fragments = shell(size);
    const VoxelOctree tree = treeOf(listOf(fragments, size));
    const int longest = std::max({size.x, size.y, size.z});
    REQUIRE((2 << tree.depth) >= longest);
    if (tree.depth > 0) REQUIRE((1 << tree.depth) < longest);
    const auto voxels = filledVoxels(cellsOf(fragments), tree.depth + 1);
    const auto shown = tree.shown->downloadValues<std::array<std::uint32_t, 2>>();
    const auto corners = tree.corners->downloadValues<std::array<std::uint32_t, 8>>();
    std::size_t bricks = 0, firstWord = 0, records = 0, wrong = 0;
    for (int level = tree.depth; level >= 0; --level) {
      const int along = 1 << (tree.depth - level);
      std::map<Cell, std::uint32_t> known;
      for (const auto& brick : OctreeBrickList::of(tree, level).bricks)
        known[cellOf(brick.place)] = brick.index;
      bricks += known.size();
      const auto& filled = voxels[static_cast<std::size_t>(level)];
      CAPTURE(size.x, size.y, size.z, level);
      CHECK(nodesOf(tree, level) == ownersOf(filled));
      const std::set<Cell> expected = nodesWith(filled, along);
      std::set<Cell> found;
      for (int z = 0; z < along; ++z)
        for (int y = 0; y < along; ++y)
          for (int x = 0; x < along; ++x) {
            std::uint32_t morton = 0;
            for (int bit = 0; bit < 10; ++bit)
              morton |= static_cast<std::uint32_t>((x >> bit & 1) | (y >> bit & 1) << 1 | (z >> bit & 1) << 2)
                        << (3 * bit);
            const auto& [tags, before] = shown.at(firstWord + morton / 32);
            const std::uint32_t bit = 1u << morton % 32;
            if ((tags & bit) == 0) continue;
            found.insert({x, y, z});
            ++records;
            const auto& around =
                corners.at(before + static_cast<std::uint32_t>(std::popcount(tags & (bit - 1))));
            for (int corner = 0; corner < 8; ++corner) {
              const auto brick = known.find({x + (corner & 1), y + (corner >> 1 & 1), z + (corner >> 2)});
              wrong +=
                  around[static_cast<std::size_t>(corner)] != (brick == known.end() ? kNone : brick->second);
            }
          }
      CHECK(found == expected);
      firstWord += (static_cast<std::size_t>(along) * along * along + 31) / 32;
    }
    CHECK(wrong == 0);
    CHECK(records == wantedOf(tree)[1]);
    // Not one more than there are.
    CHECK(tree.brickRoom == std::max<std::size_t>(bricks, 1));
    CHECK(tree.leafRoom == std::max<std::size_t>(nodesOf(tree, 0).size(), 1));
  }
}

TEST_CASE("the tree does not depend on the order of the fragments, to the bit") {
  const glm::ivec3 size(40);
  std::vector<FragmentData> fragments = shell(size);
  const VoxelOctree first = treeOf(listOf(fragments, size));
  std::shuffle(fragments.begin(), fragments.end(), std::mt19937(5));
  const VoxelOctree second = treeOf(listOf(fragments, size));
  CHECK(first.shown->download() == second.shown->download());
  CHECK(first.corners->download() == second.corners->download());
  CHECK(first.bricks->download() == second.bricks->download());
  CHECK(first.levels->download() == second.levels->download());
  CHECK(first.ranks->download() == second.ranks->download());
}

TEST_CASE("a list without fragments gives a tree without bricks") {
  const VoxelOctree tree = treeOf(listOf({}, glm::ivec3(16)));
  CHECK(wantedOf(tree) == std::array<std::uint32_t, 2>{0, 0});
  for (int level = 0; level <= tree.depth; ++level) CHECK(nodesOf(tree, level).empty());
}

TEST_CASE("a tree that outgrows its room is made again with all of it, and a smaller one keeps the room") {
  const glm::ivec3 size(32);
  const Scene scene = cones::emptyScene();
  PassHarness harness(device(), techniques(), "voxel_cone_tracing", "octree", scene, snapshotOf(scene, 0.0));
  const auto made = [&](const std::vector<FragmentData>& fragments) {
    harness.setInput("fragments", listOf(fragments, size));
    harness.run();
    const VoxelOctree tree = harness.output<VoxelOctree>("tree");
    CHECK(nodesOf(tree, 0) == ownersOf(cellsOf(fragments)));
    return tree;
  };
  const std::vector<FragmentData> few{fragmentAt({3, 5, 9})}, many = shell(size);
  const std::uint64_t small = made(few).brickRoom, large = made(many).brickRoom;
  CHECK(small < large);
  const VoxelOctree again = made(few);
  CHECK(again.brickRoom == large);
  CHECK(wantedOf(again)[0] == small);
}

TEST_CASE("the octree takes the share of the dense grid's memory that the card says") {
  struct Claim {
    const char* scene;
    int resolution;
    double share;  // of the bytes of the dense grid with its mips
  };
  for (const Claim& claim :
       {Claim{"cornell", 64, 0.305}, Claim{"cornell", 128, 0.166}, Claim{"cornell", 256, 0.087},
        Claim{"arcade", 128, 0.458}, Claim{"arcade", 256, 0.268}}) {
    const Scene scene = loadScene(sourceDirectory() / "scenes" / (std::string(claim.scene) + ".scene"));
    PassHarness voxels(device(), techniques(), "voxelization", "conservative", scene, snapshotOf(scene, 0.0));
    voxels.setParameter("resolution", claim.resolution);
    voxels.run();
    const auto list = voxels.output<VoxelFragments>("fragments");
    const double dense = static_cast<double>(list.grid.voxelCount()) * 16.0 * 8.0 / 7.0;
    CAPTURE(claim.scene, claim.resolution);
    CHECK(static_cast<double>(storeBytes(treeOf(list))) / dense == Approx(claim.share).epsilon(0.05));
  }
}
