// The nodes of a sparse voxel octree from a list of fragments: Crassin et al. 2011, Sec. 4; thesis Gomes
// 2015, Sec. 3.1.1 and 4.2.2.
#include "octree.h"

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "lumivox/toolkit/bindings.h"

namespace lumivox::voxel_cone_tracing {

using namespace shaders::voxel_cone_tracing;

OctreeBinding::OctreeBinding(const VoxelOctree& tree, int poolShift)
    : shader::BindingSet{
          shader::UniformSlot<octree_nodes::Octree>{"Octree"}({.octreeDepth = tree.depth,
                                                               .octreePoolShift = poolShift,
                                                               .octreeRanked = tree.ranks != nullptr,
                                                               .octreeSide = tree.brickSide()}),
          // A tree without one of them has the other, which a shader that asks first never
          // reads in its place.
          shader::StorageSlot{"OctreeRanks"}(tree.ranks != nullptr ? tree.ranks : tree.nodes),
          shader::StorageSlot{"OctreeNodes"}(tree.nodes != nullptr ? tree.nodes : tree.ranks),
          shader::StorageSlot{"OctreeLevels"}(tree.levels),
          shader::StorageSlot{"OctreeBricks"}(tree.bricks)} {
  if (tree.bricksAre == VoxelOctree::Bricks::published) return;
  add(shader::StorageSlot{"OctreeShown"}(tree.shown));
  add(shader::StorageSlot{"OctreeCorners"}(tree.corners));
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

/// Words of tags before those of a depth (shaders/voxel_cone_tracing/octree_tags.glsl).
std::uint64_t firstWord(int depth) {
  return depth < 2 ? static_cast<std::uint64_t>(depth) : 2 + ((std::uint64_t{1} << (3 * depth - 5)) - 2) / 7;
}

class OctreePass : public Pass {
  using Voxels = VoxelOctree::Voxels;
  using Bricks = VoxelOctree::Bricks;

  In<VoxelFragments> fragments{this, "fragments", "surface samples"};
  Param<Voxels> voxels{
      this, "voxels", Voxels::asGrid,
      "where voxels lie: at all levels as in a dense grid; at the corners of nodes (Crassin et al. 2011); in the eighths of leaves, with only the nodes that fragments lie in (as published in the thesis)"};
  Param<bool> asPublished{
      this, "as_published", false,
      "the nodes of one depth after another: every fragment searches its own from the root and tags it, and atomic counters give places (Listings 4.17 to 4.22); off: all depths at once, the same tree in an order of its own"};
  Param<Bricks> bricks{
      this, "bricks", Bricks::own,
      "voxels of a brick: its own 2 x 2 x 2, each voxel held once, and neighbours' found by rank; or, as published, 3 x 3 x 3 with those that neighbours hold too. Own ones are those of 'voxels as_grid' with 'as_published off'; elsewhere bricks are as published"};
  Out<VoxelOctree> tree{this, "tree", "nodes, and places for their bricks"};

  /// The most that any frame wanted, which is what later ones get.
  std::uint32_t bricks_ = 0, leaves_ = 0;
  std::uint32_t records_ = 0;               ///< tiles of nodes, or bricks around nodes
  std::vector<std::uint32_t> bricksAbove_;  ///< those of lesser depths, by depth

  void run(PassContext& frame) override {
    VoxelOctree result;
    result.grid = fragments->grid;
    result.voxels = voxels;
    if (voxels == Voxels::asGrid && !asPublished) result.bricksAre = bricks;
    const bool own = result.bricksAre == Bricks::own;
    const int longest = result.grid.longest();
    while ((2 << result.depth) < longest) ++result.depth;
    result.brickRoom = std::max(bricks_, 1u);
    for (std::size_t depth = 1; depth < bricksAbove_.size(); ++depth)
      result.bricksDownTo.push_back(bricksAbove_[depth]);
    result.bricksDownTo.push_back(bricks_);
    result.leafRoom = std::max(leaves_, 1u);
    const std::uint64_t records = std::max(records_, 1u);
    if (own) {
      result.corners = frame.buffer(records * VoxelOctree::kCornersBytes, "octree bricks around nodes");
    } else {
      result.nodes = frame.buffer(records * VoxelOctree::kTileBytes, "octree nodes");
      result.nodes->clear(~0u);
    }
    result.bricks = frame.buffer(result.brickRoom * VoxelOctree::kBrickBytes, "octree bricks");
    result.levels = frame.buffer(VoxelOctree::levelsBytes(result.depth), "octree levels");
    if (asPublished) {
      subdivide(frame, result);
    } else {
      write(frame, result);
    }
    if (!own)
      forEachBrick(frame, frame.program(octree_neighbours::kProgram), {OctreeBinding(result)}, result,
                   result.depth + 1, 1);
    judge(frame, result.levels, 0, bricks_);
    judge(frame, result.levels, 1, records_);
    judge(frame, result.levels, 2, leaves_);
    bricksAbove_.resize(static_cast<std::size_t>(result.depth) + 1);
    for (std::size_t depth = 1; depth < bricksAbove_.size(); ++depth)
      judge(frame, result.levels, VoxelOctree::kLevelsBegin + VoxelOctree::kLevelWords * depth,
            bricksAbove_[depth]);
    tree = result;
  }

  void write(PassContext& frame, VoxelOctree& result) {
    const std::uint64_t words = firstWord(result.depth + 1), chunks = (words + kChunk - 1) / kChunk;
    const int wordCount = static_cast<int>(words);
    const bool own = result.bricksAre == Bricks::own;
    const gpu::BufferRef tags = frame.emptyElements(octree_mark::tags, words, "tags of octree nodes"),
                         counts = frame.elements(octree_count::chunkCounts, chunks, "counts of octree nodes"),
                         records = frame.elements(octree_rank::records, words, "ranks of octree records");
    // Where bricks hold all that their nodes show, the tags say both.
    const gpu::BufferRef shown =
        own ? frame.emptyElements(octree_mark::shown, words, "octree nodes that show something") : tags;
    result.ranks = frame.elements(octree_rank::octreeRanks, words, "ranks of octree nodes");
    if (own) result.shown = records;
    const OctreeBinding bound(result);
    forEachFragment(
        frame, frame.program(octree_mark::kProgram),
        {octree_mark::marks({.depth = result.depth, .voxels = static_cast<int>(result.voxels), .own = own}),
         octree_mark::tags(tags), octree_mark::shown(shown)},
        *fragments);
    frame.dispatchList(frame.program(octree_count::kProgram),
                       {octree_count::words({wordCount, own}), octree_count::tags(tags),
                        octree_count::shown(shown), octree_count::chunkCounts(counts)},
                       chunks);
    frame.dispatch(frame.program(octree_scan::kProgram),
                   {octree_scan::chunks({static_cast<int>(chunks)}), octree_scan::chunkCounts(counts), bound},
                   {1, 1, 1});
    frame.dispatchList(frame.program(octree_rank::kProgram),
                       {octree_rank::words({wordCount, own}), octree_rank::tags(tags),
                        octree_rank::shown(shown), octree_rank::chunkCounts(counts),
                        octree_rank::records(records), octree_rank::octreeRanks(result.ranks)},
                       chunks);
    frame.dispatch(frame.program(octree_arguments::Variant{}),
                   {octree_arguments::room({bricks_, records_}), bound}, {result.depth + 2, 1, 1});
    frame.dispatchList(
        frame.program(octree_nodes::Variant{.bricks = own ? octree_nodes::Variant::bricksOwn
                                                          : octree_nodes::Variant::bricksPublished}),
        {octree_nodes::nodeRoom({bricks_, records_, static_cast<std::uint32_t>(words)}),
         octree_nodes::records(records), bound},
        words);
  }

  /// Depth after depth. Where a depth has too little room the next ones find no nodes: each time that the
  /// frame is rendered anew one more depth is counted.
  void subdivide(PassContext& frame, const VoxelOctree& result) {
    std::vector<std::uint32_t> words(VoxelOctree::levelsBytes(result.depth) / sizeof(std::uint32_t));
    words[1] = 1;  // the root's tile
    result.levels->uploadValues(std::span<const std::uint32_t>(words));
    const std::uint32_t brickRoom = bricks_, tileRoom = records_;
    const gpu::BufferRef range = frame.uploaded(std::array<std::uint32_t, 5>{}, "octree nodes of a depth");
    constexpr std::uint64_t kGroups = 2 * sizeof(std::uint32_t);  // in `range`
    const OctreeBinding bound(result);
    for (int depth = 0; depth <= result.depth; ++depth) {
      forEachFragment(frame, frame.program(octree_tag::kProgram),
                      {octree_tag::tag({.depth = depth, .voxels = static_cast<int>(result.voxels)}), bound},
                      *fragments);
      frame.dispatch(frame.program(octree_range::kProgram),
                     {octree_range::range({depth, tileRoom}), octree_range::nodeRange(range), bound},
                     {1, 1, 1});
      frame.dispatchIndirect(frame.program(octree_subdivide::kProgram),
                             {octree_subdivide::subdivision({depth, brickRoom, tileRoom}),
                              octree_subdivide::nodeRange(range), bound},
                             *range, kGroups);
    }
    frame.dispatch(frame.program(octree_arguments::Variant{.published = 1}),
                   {octree_arguments::room({brickRoom, tileRoom}), bound}, {result.depth + 2, 1, 1});
  }

  static constexpr std::uint64_t kChunk = 64;  // words that a thread counts

  /// Where a frame wanted more than there was room for, it is rendered again with as much as it wanted.
  static void judge(PassContext& frame, const gpu::BufferRef& levels, std::uint64_t word,
                    std::uint32_t& room) {
    frame.judgeLater(levels, word * sizeof(std::uint32_t), [&room](PassContext&, std::uint32_t wanted) {
      const bool fits = wanted <= room;
      room = std::max(room, wanted);
      return fits;
    });
  }
};

}  // namespace

void addOctree(TechniqueRegistry& registry) {
  registry.add<OctreePass>("octree", "Nodes of a sparse voxel octree (Crassin et al. 2011, Sec. 4)");
}

}  // namespace lumivox::voxel_cone_tracing
