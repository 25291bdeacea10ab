// Builds the nodes of a sparse voxel octree from a list of fragments: Crassin et al. 2011, Sec. 4; thesis
// Gomes 2015, Sec. 3.1.1 and 4.2.2.
#include "octree.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/toolkit/bindings.h"
#include "lumivox/toolkit/bit_tree.h"
#include "lumivox/toolkit/change_tracking.h"
#include "lumivox/toolkit/counts.h"
#include "lumivox/toolkit/room.h"

namespace lumivox::voxel_cone_tracing {

using namespace shaders::voxel_cone_tracing;

OctreeBinding::OctreeBinding(const VoxelOctree& tree, int poolShift)
    : shader::BindingSet{shader::UniformSlot<octree_nodes::Octree>{"Octree"}(
                             {.octreeDepth = tree.depth, .octreePoolShift = poolShift}),
                         shader::StorageSlot{"OctreeRanks"}(tree.ranks),
                         shader::StorageSlot{"OctreeLevels"}(tree.levels),
                         shader::StorageSlot{"OctreeBricks"}(tree.bricks),
                         shader::StorageSlot{"OctreeShown"}(tree.shown),
                         shader::StorageSlot{"OctreeCorners"}(tree.corners)} {}

namespace {

/// Bytes of a tree of a given depth or less: tags and ranks, and nodes with their places, as far as counted.
struct TreeBytes {
  std::uint64_t tags = 0, nodes = 0;
};
TreeBytes treeBytes(const VoxelOctree& tree, int depth) {
  const std::uint64_t bricks = tree.bricksDownTo[static_cast<std::size_t>(depth)], all = tree.brickRoom,
                      shown = tree.shownRoom * bricks / all;
  return {wordsBeforeDepth(depth + 1) * (2 * 4 + 2 * 8),
          bricks * VoxelOctree::kBrickBytes + shown * VoxelOctree::kCornersBytes};
}
/// Bytes of its bricks, with the sums that fill the leaves.
std::uint64_t brickBytes(const VoxelOctree& tree, int depth, const VoxelBytes& voxel) {
  const std::uint64_t bricks = tree.bricksDownTo[static_cast<std::size_t>(depth)],
                      leaves = depth > 0 ? bricks - tree.bricksDownTo[static_cast<std::size_t>(depth) - 1]
                                         : bricks;
  return bricks * VoxelOctree::kBrickVoxels * voxel.texels + 8 * leaves * voxel.sums;
}

}  // namespace

void requireRoom(PassContext& frame, const VoxelOctree& tree, const VoxelBytes& voxel, bool holdsTree) {
  if (!tree.needsMore) return;
  const TreeBytes all = treeBytes(tree, tree.depth);
  const std::uint64_t held = holdsTree ? all.tags + all.nodes : 0;
  const auto bytesOf = [&](int depth) {
    const TreeBytes some = treeBytes(tree, depth);
    return some.tags + some.nodes + brickBytes(tree, depth, voxel);
  };
  const auto missing = [&](int depth) {
    return whyNoRoom(frame, bytesOf(depth) - std::min(bytesOf(depth), held));
  };
  const std::string why = missing(tree.depth);
  if (why.empty()) return;
  int fits = tree.depth - 1;
  while (fits >= 0 && !missing(fits).empty()) --fits;
  throw Error(fmt::format(
      "an octree of {} voxels along its longest side takes {}{}: tags {}, nodes {}, {} bricks {}; of sizes halved from it {} ({})",
      tree.grid.longest(), tree.bricksDownTo.back() > 0 ? "" : "at least ", formatBytes(bytesOf(tree.depth)),
      formatBytes(all.tags), formatBytes(all.nodes), tree.bricksDownTo.back(),
      formatBytes(brickBytes(tree, tree.depth, voxel)),
      fits < 0 ? "none fits"
               : fmt::format("the largest that fits is {}", tree.grid.longest() >> (tree.depth - fits)),
      why));
}

shader::BindingSet stillBinding(const RadianceOctree& octree) {
  if (octree.still == nullptr) return {};
  return {octree.changed.bindings(),
          shader::UniformSlot<octree_filter::StillBricks>{"StillBricks"}({octree.still->poolShift}),
          shader::StorageSlot{"StillRanks"}(octree.still->tree.ranks),
          shader::SampledSlot{"stillPool"}(octree.still->radiance, gpu::Sampling::nearest)};
}

void forEachBrick(PassContext& frame, const shader::BoundProgram& program, const shader::BindingSet& bindings,
                  const VoxelOctree& tree, int depth, int threads) {
  const auto kind = static_cast<std::uint64_t>(
      std::find(VoxelOctree::kThreads.begin(), VoxelOctree::kThreads.end(), threads) -
      VoxelOctree::kThreads.begin());
  const std::uint64_t words = VoxelOctree::kLevelsBegin +
                              VoxelOctree::kLevelWords * static_cast<std::uint64_t>(depth) +
                              VoxelOctree::kLevelGroups + 3 * kind;
  frame.dispatchIndirect(program, bindings, *tree.levels, words * sizeof(std::uint32_t));
}

namespace {

class OctreePass : public Pass {
  In<VoxelFragments> fragments{this, "fragments", "surface samples"};
  Out<VoxelOctree> tree{this, "tree", "nodes, and places for their bricks"};

  /// Sizes of trees: the most that any frame wanted, which later frames get.
  struct Room {
    std::uint32_t bricks = 0, leaves = 0;
    std::uint32_t shown = 0;                 ///< nodes in which reads find something
    std::vector<std::uint32_t> bricksAbove;  ///< bricks of lesser depths, by depth
    bool operator==(const Room&) const = default;
  };
  Room room_, stillRoom_;
  std::optional<Room> roomBefore_, stillRoomBefore_;  ///< of the run before

  /// A bit for each possible node: those with bricks, and those in which reads find something.
  struct Tags {
    gpu::BufferRef nodes, shown;
  };
  struct Still {
    Tags tags;
    std::shared_ptr<const VoxelOctree> tree;
  };

  void run(PassContext& frame) override {
    auto [result, tags] = placed(frame, room_, roomBefore_);
    if (fragments->still != nullptr) {
      const Still& still =
          frame.kept("nodes of static geometry", fragments->still, [&] { return nodesOfStill(frame); });
      result.still = still.tree;
      const int words = static_cast<int>(wordsOf(result));
      frame.dispatchList(frame.program(octree_copy_tags::kProgram),
                         {octree_copy_tags::words({words}), octree_copy_tags::stillTags(still.tags.nodes),
                          octree_copy_tags::stillShown(still.tags.shown), octree_copy_tags::tags(tags.nodes),
                          octree_copy_tags::shown(tags.shown)},
                         wordsOf(result));
      mark(frame, result, movingOf(*fragments), tags, {.moving = 1});
      write(frame, result, tags, room_);
    } else {
      mark(frame, result, *fragments, tags, {});
      write(frame, result, tags, room_);
    }
    judge(frame, result, room_);
    tree = result;
  }

  Still nodesOfStill(PassContext& frame) {
    auto [result, tags] = placed(frame, stillRoom_, stillRoomBefore_);
    Still still{tags, nullptr};
    mark(frame, result, staticOf(*fragments), still.tags, {});
    write(frame, result, still.tags, stillRoom_);
    judge(frame, result, stillRoom_);
    still.tree = std::make_shared<const VoxelOctree>(result);
    return still;
  }

  /// An empty tree of this size, and its tags.
  std::pair<VoxelOctree, Tags> placed(PassContext& frame, const Room& room,
                                      std::optional<Room>& before) const {
    VoxelOctree result;
    result.grid = fragments->grid;
    result.depth = voxelDepthOver(result.grid) - 1;
    result.brickRoom = std::max(room.bricks, 1u);
    result.leafRoom = std::max(room.leaves, 1u);
    result.shownRoom = std::max(room.shown, 1u);
    result.needsMore = before != room;
    result.bricksDownTo.assign(static_cast<std::size_t>(result.depth) + 1, 0);
    for (std::size_t depth = 1; depth < std::min(room.bricksAbove.size(), result.bricksDownTo.size());
         ++depth)
      result.bricksDownTo[depth - 1] = room.bricksAbove[depth];
    result.bricksDownTo.back() = room.bricks;
    before = room;
    requireRoom(frame, result, {.texels = 4 * sizeof(float), .sums = add::sums.elementBytes}, false);
    return taken(frame, result);
  }

  std::pair<VoxelOctree, Tags> taken(PassContext& frame, VoxelOctree result) const {
    Tags tags;
    result.corners =
        frame.buffer(result.shownRoom * VoxelOctree::kCornersBytes, "octree bricks around nodes");
    result.bricks = frame.buffer(result.brickRoom * VoxelOctree::kBrickBytes, "octree bricks");
    result.levels = frame.buffer(VoxelOctree::levelsBytes(result.depth), "octree levels");
    const std::uint64_t words = wordsOf(result);
    result.ranks = frame.elements(octree_rank::octreeRanks, words, "ranks of octree nodes");
    tags.nodes = frame.emptyElements(octree_mark::tags, words, "tags of octree nodes");
    result.shown =
        frame.elements(octree_rank::shownRanks, words, "ranks of octree nodes that show something");
    tags.shown = frame.emptyElements(octree_mark::shown, words, "octree nodes that show something");
    return {result, tags};
  }

  static std::uint64_t wordsOf(const VoxelOctree& result) { return wordsBeforeDepth(result.depth + 1); }

  static void mark(PassContext& frame, const VoxelOctree& result, const VoxelFragments& list,
                   const Tags& tags, const octree_mark::Variant& variant) {
    shader::BindingSet bindings{octree_mark::marks({result.depth}), octree_mark::tags(tags.nodes),
                                octree_mark::shown(tags.shown)};
    if (variant.moving != 0) bindings.add(bindStaticCount(list));
    forEachFragment(frame, frame.program(variant), bindings, list);
  }

  static void write(PassContext& frame, VoxelOctree& result, const Tags& tags, const Room& room) {
    const std::uint64_t words = wordsOf(result), chunks = (words + kChunk - 1) / kChunk;
    const int wordCount = static_cast<int>(words);
    const gpu::BufferRef counts = frame.elements(octree_count::chunkCounts, chunks, "counts of octree nodes");
    const OctreeBinding bound(result);
    frame.dispatchList(frame.program(octree_count::kProgram),
                       {octree_count::words({wordCount}), octree_count::tags(tags.nodes),
                        octree_count::shown(tags.shown), octree_count::chunkCounts(counts)},
                       chunks);
    scan(frame, counts, chunks, 2, result.levels);  // which begins with the wanted bricks and tiles
    frame.dispatchList(frame.program(octree_rank::kProgram),
                       {octree_rank::rankRoom({room.bricks, room.shown, static_cast<std::uint32_t>(words)}),
                        octree_rank::octreeLevels(result.levels), octree_rank::tags(tags.nodes),
                        octree_rank::shown(tags.shown), octree_rank::chunkCounts(counts),
                        octree_rank::shownRanks(result.shown), octree_rank::octreeRanks(result.ranks)},
                       chunks);
    frame.dispatch(frame.program(octree_arguments::kProgram),
                   {octree_arguments::room({room.bricks, room.shown, room.leaves}), bound},
                   {result.depth + 2, 1, 1});
    frame.dispatchList(
        frame.program(octree_nodes::kProgram),
        {octree_nodes::nodeRoom({room.bricks, room.shown, static_cast<std::uint32_t>(words)}), bound}, words);
  }

  static constexpr std::uint64_t kChunk = 64;  // words that a thread counts

  /// A frame that wanted more room than there was is rendered again with as much as it wanted, and a
  /// sixteenth more where motion lets the number vary.
  void judge(PassContext& frame, const VoxelOctree& result, Room& room) const {
    const std::uint32_t share = &room == &room_ && fragments->still != nullptr ? 16 : 0;
    for (auto [word, wanted] : {std::pair{0, &room.bricks}, {1, &room.shown}, {2, &room.leaves}})
      judge(frame, result.levels, static_cast<std::uint64_t>(word), *wanted, share, true);
    room.bricksAbove.resize(static_cast<std::size_t>(result.depth) + 1);
    for (std::size_t depth = 1; depth < room.bricksAbove.size(); ++depth)
      judge(frame, result.levels, VoxelOctree::kLevelsBegin + VoxelOctree::kLevelWords * depth,
            room.bricksAbove[depth], 0, false);
  }
  static void judge(PassContext& frame, const gpu::BufferRef& levels, std::uint64_t word, std::uint32_t& room,
                    std::uint32_t share, bool isRoom) {
    frame.checkAfterFrame(levels, word * sizeof(std::uint32_t),
                          [=, &room](PassContext&, std::uint32_t wanted) {
                            if (wanted <= room) return true;
                            room = wanted + (share > 0 ? wanted / share : 0);
                            return !isRoom;
                          });
  }
};

}  // namespace

void addOctree(TechniqueRegistry& registry) {
  registry.add<OctreePass>("octree", "Nodes of a sparse voxel octree (Crassin et al. 2011, Sec. 4)");
}

}  // namespace lumivox::voxel_cone_tracing
