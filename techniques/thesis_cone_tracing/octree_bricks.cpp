// The bricks of a sparse voxel octree: attributes of fragments in the corners of leaves, coarser depths, and
// the light of photons (thesis Gomes 2015, Sec. 3.1.3 and 4.2.2, Listings 4.23 and 4.24; Crassin et al. 2011,
// Sec. 4 to 6).
#include <array>

#include "lumivox/base/error.h"
#include "lumivox/toolkit/bindings.h"
#include "octree.h"

namespace lumivox::thesis_cone_tracing {

using namespace shaders::thesis_cone_tracing;

namespace {

/// In the order of octree_transfer.comp.
enum class Transfer { add, copy, average };

/// Completes the voxels that bricks of a depth share with their neighbours along x, y and z: both parts are
/// added or averaged, or the higher one is copied to the lower one.
void transferBorders(PassContext& frame, const OctreeBricks& octree, int depth, Transfer way) {
  const auto along = [&](int axis, Transfer how) {
    forEachBrick(
        frame,
        frame.program(octree_transfer::Variant{}, octree_transfer::Constants{.way = static_cast<int>(how)}),
        {octree_transfer::borders({depth, axis}),
         octree_transfer::pool(octree.radiance, gpu::Sampling::nearest),
         octree_transfer::poolImage(octree.radiance), OctreeBinding(octree.tree, octree.poolShift)},
        octree.tree, depth, 9);
  };
  for (int axis = 0; axis < 3; ++axis) {
    along(axis, way);
    if (way == Transfer::add) along(axis, Transfer::copy);
  }
}

/// Fills all depths above the leaves: centres, faces, edges and corners of bricks in turn, as means that
/// neighbours average or as shares that they add up.
void fillLevels(PassContext& frame, OctreeBricks& octree, bool means) {
  constexpr std::array<int, 4> kPartThreads{1, 6, 12, 8};
  for (int depth = octree.tree.depth - 1; depth >= 0; --depth) {
    for (int part = 0; part < 4; ++part)
      forEachBrick(frame, frame.program(octree_parts::Variant{}, octree_parts::Constants{.part = part}),
                   {octree_parts::parts({.depth = depth, .means = means}),
                    octree_parts::pool(octree.radiance, gpu::Sampling::nearest),
                    octree_parts::poolImage(octree.radiance), OctreeBinding(octree.tree, octree.poolShift)},
                   octree.tree, depth, kPartThreads[static_cast<std::size_t>(part)]);
    transferBorders(frame, octree, depth, means ? Transfer::average : Transfer::add);
  }
  octree.filledLevels = octree.tree.depth + 1;
}

/// Makes a pool for all bricks, about a cube with less than one empty layer.
void makePool(PassContext& frame, OctreeBricks& octree) {
  octree.poolShift = 0;
  while ((std::uint64_t{1} << (3 * (octree.poolShift + 1))) <= octree.tree.brickRoom) ++octree.poolShift;
  const int row = OctreeNodes::kBrickSide << octree.poolShift;
  const std::uint64_t layer = std::uint64_t{1} << (2 * octree.poolShift),
                      layers = (octree.tree.brickRoom + layer - 1) / layer;
  octree.radiance = frame.volume({row, row, OctreeNodes::kBrickSide * static_cast<int>(layers)},
                                 gpu::Format::rgba32f, "octree bricks");
}

gpu::BufferRef emptySums(PassContext& frame, const OctreeNodes& tree) {
  return frame.emptyElements(octree_bricks::sums, 8 * tree.leafRoom, "sums of voxels");
}

/// Fills the bricks of leaves from the sums of their voxels, with the opacity of other bricks unless these
/// are null.
void resolveLeaves(PassContext& frame, const OctreeBricks& octree, const gpu::BufferRef& sums,
                   bool coverageSum, const gpu::TextureRef& opaque = nullptr) {
  const bool inLeaves = octree.tree.voxels == OctreeNodes::Voxels::inLeaves;
  forEachBrick(frame, frame.program(octree_bricks::kProgram),
               {octree_bricks::leaves({.coverageSum = coverageSum, .keepsOpacity = opaque != nullptr}),
                octree_bricks::sums(sums),
                octree_bricks::opaque(opaque != nullptr ? opaque : octree.radiance, gpu::Sampling::nearest),
                octree_bricks::poolImage(octree.radiance), OctreeBinding(octree.tree, octree.poolShift)},
               octree.tree, octree.tree.depth, OctreeNodes::kBrickVoxels);
  transferBorders(frame, octree, octree.tree.depth, inLeaves ? Transfer::average : Transfer::copy);
}

constexpr int kStages = 2;  // of octree_sums.glsl

/// The quantities that octree_leaves.comp averages, in its order.
enum class Surface { light, colour, normal };

/// The leaves of a tree with the mean attributes of fragments.
OctreeBricks leavesOf(PassContext& frame, const OctreeNodes& tree, const VoxelFragments& fragments,
                      Surface what, float ambient) {
  OctreeBricks result;
  result.tree = tree;
  makePool(frame, result);
  const gpu::BufferRef sums = emptySums(frame, tree);
  for (int stage = 0; stage < kStages; ++stage)
    forEachFragment(frame,
                    frame.program(octree_leaves::Variant{},
                                  octree_leaves::Constants{.stage = stage, .what = static_cast<int>(what)}),
                    {octree_leaves::surfaces({ambient}), octree_leaves::sums(sums), OctreeBinding(tree)},
                    fragments);
  resolveLeaves(frame, result, sums, fragments.coverage == VoxelFragments::Coverage::sum);
  return result;
}

class OctreeLeavesPass : public Pass {
  In<VoxelFragments> fragments{this, "fragments", "surface samples"};
  In<OctreeNodes> tree{this, "tree", "the nodes that the fragments make"};
  Param<float> ambient{this, "ambient", 0.0f, within(0.0f, 1e9f),
                       "irradiance that all surfaces receive besides the photons, W/m^2 (Fig. 66)"};
  Out<OctreeBricks> radiance{this, "radiance", "reflected radiance and opacity; the finest level only",
                             Levels::finest};

  void run(PassContext& frame) override {
    if (fragments->reflected != nullptr)
      throw Error(
          "thesis_cone_tracing.octree_leaves: input 'fragments' brings along direct light that the image has, and leaves hold none; expected fragments without it ('direct' of voxelization.reproject left out)");
    radiance = leavesOf(frame, *tree, *fragments, Surface::light, ambient);
  }
};

class OctreeMipmapPass : public Pass {
  enum class Borders { averaged, added };

  In<OctreeBricks> radiance{this, "radiance", "the finest level"};
  Param<Borders> borders{
      this, "borders", Borders::averaged,
      "how bricks combine a border voxel of which each holds a part; averaged: parts are means, and are averaged; added: parts are added to the right and copied to the left (Crassin et al. 2011)"};
  Out<OctreeBricks> mips{this, "mips", "the same octree with values at all depths", Levels::all};

  void run(PassContext& frame) override {
    OctreeBricks result = *radiance;
    fillLevels(frame, result, borders == Borders::averaged);
    mips = result;
  }
};

class OctreeRelightPass : public Pass {
  In<ReflectiveShadowMap> photons{this, "photons", Presence::optional,
                                  "what the lights see; without it the octree stays as it is"};
  In<OctreeBricks> octree{this, "octree", "surfaces, of which the opacity is kept", Levels::all};
  In<VoxelFragments> fragments{this, "fragments",
                               "the surface samples of the octree: their colours and normals"};
  Out<OctreeBricks> radiance{this, "radiance", "the same octree with the photons' light at all depths",
                             Levels::all};

  void run(PassContext& frame) override {
    if (!photons.present()) {
      radiance = *octree;
      return;
    }
    OctreeBricks result;
    result.tree = octree->tree;
    const OctreeNodes& tree = result.tree;
    if (tree.voxels != OctreeNodes::Voxels::inLeaves)
      throw Error(
          "thesis_cone_tracing.octree_relight: photons light the colours and normals in the corners of leaves; expected 'voxels in_leaves' in thesis_cone_tracing.octree");
    if (fragments->reflected != nullptr)
      throw Error(
          "thesis_cone_tracing.octree_relight: input 'fragments' brings along direct light that the image has, and Listing 4.24 lights all voxels by photons; expected fragments without it ('direct' of voxelization.reproject left out)");
    makePool(frame, result);
    const OctreeBricks colours = leavesOf(frame, tree, *fragments, Surface::colour, 0.0f),
                       normals = leavesOf(frame, tree, *fragments, Surface::normal, 0.0f);
    const gpu::BufferRef sums = emptySums(frame, tree);
    const gpu::TextureDescription& map = photons->position->description();
    const glm::ivec3 size(map.width, map.height, map.depth);
    constexpr auto kNearest = gpu::Sampling::nearest;
    for (int stage = 0; stage < kStages; ++stage)
      frame.dispatchList(
          frame.program(octree_relight::Variant{}, octree_relight::Constants{.stage = stage}),
          {octree_relight::photons(
               {.gridLow = tree.grid.low, .voxelSize = tree.grid.voxelSize, .mapSize = size}),
           octree_relight::photonPosition(photons->position, kNearest),
           octree_relight::photonNormal(photons->normal, kNearest),
           octree_relight::photonFlux(photons->flux, kNearest), octree_relight::lights(photons->lights),
           octree_relight::pool(octree->radiance, kNearest),
           octree_relight::colours(colours.radiance, kNearest),
           octree_relight::normals(normals.radiance, kNearest), octree_relight::sums(sums),
           OctreeBinding(tree, result.poolShift)},
          GridPlacement{.resolution = size}.voxelCount());
    resolveLeaves(frame, result, sums, false, octree->radiance);
    fillLevels(frame, result, true);
    radiance = result;
  }
};

}  // namespace

void addOctreeBricks(TechniqueRegistry& registry) {
  registry.add<OctreeLeavesPass>("octree_leaves",
                                 "Fragments averaged in the corners of leaves (Listing 4.23)");
  registry.add<OctreeMipmapPass>("octree_mipmap",
                                 "Coarser depths of the bricks (Sec. 4.2.2, Fig. 70 and 71)");
  registry.add<OctreeRelightPass>("octree_relight",
                                  "Photons of a reflective shadow map relight the leaves (Listing 4.24)");
}

}  // namespace lumivox::thesis_cone_tracing
