// Builds the nodes of a sparse voxel octree from a list of fragments, depth by depth (thesis Gomes 2015, Sec.
// 4.2.2, Listings 4.16 to 4.22).
#include "octree.h"

#include <span>

#include "lumivox/toolkit/bindings.h"

namespace lumivox::thesis_cone_tracing {

using namespace shaders::thesis_cone_tracing;

OctreeBinding::OctreeBinding(const OctreeNodes& tree, int poolShift)
    : shader::BindingSet{shader::UniformSlot<octree_tag::Octree>{"Octree"}(
                             {.octreeDepth = tree.depth,
                              .octreePoolShift = poolShift,
                              .octreeAtCorners = tree.voxels == OctreeNodes::Voxels::atCorners}),
                         shader::StorageSlot{"OctreeNodes"}(tree.nodes),
                         shader::StorageSlot{"OctreeLevels"}(tree.levels),
                         shader::StorageSlot{"OctreeBricks"}(tree.bricks)} {}

void forEachBrick(PassContext& frame, const shader::BoundProgram& program, const shader::BindingSet& bindings,
                  const OctreeNodes& tree, int depth, int threads) {
  const auto kind = static_cast<std::uint64_t>(
      std::find(OctreeNodes::kThreads.begin(), OctreeNodes::kThreads.end(), threads) -
      OctreeNodes::kThreads.begin());
  const std::uint64_t words = OctreeNodes::levelWord(depth) + OctreeNodes::kLevelGroups + 3 * kind;
  frame.dispatchIndirect(program, bindings, *tree.levels, words * sizeof(std::uint32_t));
}

namespace {

class OctreePass : public Pass {
  In<VoxelFragments> fragments{this, "fragments", "surface samples"};
  Param<OctreeNodes::Voxels> voxels{
      this, "voxels", OctreeNodes::Voxels::inLeaves,
      "places of voxels; in_leaves: in the eighths of leaves, with only those nodes that contain fragments; at_corners: at the corners of nodes (Crassin et al. 2011)"};
  Out<OctreeNodes> tree{this, "tree", "nodes, and places for their bricks"};

  /// Size of the tree: the most that any frame wanted, which later frames get.
  struct Room {
    std::uint32_t bricks = 0, tiles = 0, leaves = 0;
  };
  Room room_;

  void run(PassContext& frame) override {
    OctreeNodes result;
    result.grid = fragments->grid;
    result.voxels = voxels;
    while ((2 << result.depth) < result.grid.longest()) ++result.depth;
    result.brickRoom = std::max(room_.bricks, 1u);
    result.leafRoom = std::max(room_.leaves, 1u);
    result.nodes = frame.buffer(std::max(room_.tiles, 1u) * OctreeNodes::kTileBytes, "octree nodes");
    result.nodes->clear(~0u);
    result.bricks = frame.buffer(result.brickRoom * OctreeNodes::kBrickBytes, "octree bricks");
    result.levels =
        frame.buffer(OctreeNodes::levelWord(result.depth + 1) * sizeof(std::uint32_t), "octree levels");
    subdivide(frame, result);
    // A frame that wanted more room than there was is rendered again with as much as it wanted.
    for (auto [word, wanted] : {std::pair{0, &room_.bricks}, {1, &room_.tiles}, {2, &room_.leaves}})
      frame.checkAfterFrame(result.levels, static_cast<std::uint64_t>(word) * sizeof(std::uint32_t),
                            [had = wanted](PassContext&, std::uint32_t wants) {
                              if (wants <= *had) return true;
                              *had = wants;
                              return false;
                            });
    tree = result;
  }

  /// Subdivides depth by depth. Where a depth has too little room, the next ones find no nodes; each new
  /// rendering of the frame counts one more depth.
  void subdivide(PassContext& frame, const OctreeNodes& result) const {
    std::vector<std::uint32_t> words(OctreeNodes::levelWord(result.depth + 1));
    words[1] = 1;  // the root's tile
    result.levels->uploadValues(std::span<const std::uint32_t>(words));
    const gpu::BufferRef range = frame.uploaded(std::array<std::uint32_t, 5>{}, "octree nodes of a depth");
    constexpr std::uint64_t kGroups = 2 * sizeof(std::uint32_t);  // in `range`
    const OctreeBinding bound(result);
    for (int depth = 0; depth <= result.depth; ++depth) {
      forEachFragment(frame, frame.program(octree_tag::kProgram), {octree_tag::tag({depth}), bound},
                      *fragments);
      frame.dispatch(frame.program(octree_range::kProgram),
                     {octree_range::range({depth, room_.tiles}), octree_range::nodeRange(range), bound},
                     {1, 1, 1});
      frame.dispatchIndirect(frame.program(octree_subdivide::kProgram),
                             {octree_subdivide::subdivision({depth, room_.bricks, room_.tiles}),
                              octree_subdivide::nodeRange(range), bound},
                             *range, kGroups);
    }
    frame.dispatch(frame.program(octree_dispatches::kProgram),
                   {octree_dispatches::room({room_.bricks, room_.tiles, room_.leaves}), bound},
                   {result.depth + 1, 1, 1});
    // The print looks neighbours up before each depth is tagged. Here a node holds its place in the word of
    // its neighbours until it is subdivided.
    for (int depth = 0; depth <= result.depth; ++depth)
      forEachFragment(frame, frame.program(octree_neighbours::kProgram),
                      {octree_neighbours::depth({depth}), bound}, *fragments);
  }
};

}  // namespace

void addOctree(TechniqueRegistry& registry) {
  registry.add<OctreePass>("octree", "Nodes of a sparse voxel octree (Listings 4.16 to 4.22)");
}

}  // namespace lumivox::thesis_cone_tracing
