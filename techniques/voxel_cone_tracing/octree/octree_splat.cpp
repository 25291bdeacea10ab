// Injects light from a reflective shadow map into a sparse voxel octree: photons are splatted into the leaves
// around them, and a node map finds the nodes above that change. Crassin et al. 2011, Sec. 6; thesis Gomes
// 2015, Sec. 3.1.3 and 4.2.2.
#include <algorithm>
#include <limits>

#include "lumivox/base/error.h"
#include "lumivox/toolkit/bindings.h"
#include "octree.h"

namespace lumivox::voxel_cone_tracing {

using namespace shaders::voxel_cone_tracing;

namespace {

class OctreeSplatPass : public Pass {
  In<ReflectiveShadowMap> photons{this, "photons", Presence::optional,
                                  "what the lights see; without it the octree stays as it is"};
  In<RadianceOctree> octree{this, "octree", "surfaces without that light, pre-filtered", Levels::all};
  // In the order of octree_photon_sums.comp.
  enum class Photons { summed, averaged };
  Param<Photons> rule{
      this, "photons_are", Photons::summed,
      "radiance from photons; summed: the flux of all photons in a voxel over the surface area in it, so that no light is lost (Crassin et al. 2011); averaged: the mean of each light's photons, which leaves voxels between photons dark"};
  Out<RadianceOctree> radiance{this, "radiance", "the same octree with the photons' light at all depths",
                               Levels::all};

  void run(PassContext& frame) override {
    if (!photons.present()) {
      radiance = *octree;
      return;
    }
    RadianceOctree result = *octree;
    const VoxelOctree& tree = result.tree;
    if (result.faces > 1)
      throw Error(
          "voxel_cone_tracing.octree_splat: photons light voxels that look the same from all sides; expected 'faces one' in voxel_cone_tracing.octree_inject");
    if (result.filledLevels != tree.depth + 1)
      throw Error(
          "voxel_cone_tracing.octree_splat: expected an octree with all levels, such as voxel_cone_tracing.octree_filter gives");
    result.radiance = frame.volume(poolSize(*octree->radiance), octree->radiance->description().format,
                                   "octree bricks of photons");
    const OctreeBinding bound(tree, result.poolShift);
    const gpu::BufferRef lit = frame.emptyElements(octree_lit::lit, tree.brickRoom, "bricks of photons"),
                         sums = frame.emptyElements(octree_photon_sums::sums, 8 * tree.leafRoom,
                                                    "sums of photons");
    const gpu::TextureRef nodes = nodeMap(frame, tree, bound);
    markLit(frame, *nodes, bound, lit);
    const int passes = rule == Photons::averaged ? std::max(photons->lightCount, 1) : 1;
    for (int light = 0; light < passes; ++light) {
      if (light > 0) sums->clear();
      average(frame, light, bound, nodes, sums);
      splat(frame, result, sums, light == 0 ? octree->radiance : result.radiance);
    }
    for (int depth = tree.depth - 1; depth >= 0; --depth) halve(frame, result, depth, lit);
    radiance = result;
  }

  /// Writes the bricks of `from` with the light of photons into those of `result`.
  void splat(PassContext& frame, const RadianceOctree& result, const gpu::BufferRef& sums,
             const gpu::TextureRef& from) const {
    forEachBrick(
        frame,
        frame.program(octree_splat::Variant{},
                      octree_splat::Constants{.rule = static_cast<int>(static_cast<Photons>(rule))}),
        {octree_splat::splat({result.unit, result.radiance->description().format == gpu::Format::rgba16f
                                               ? 65504.0f
                                               : std::numeric_limits<float>::max()}),
         octree_splat::sums(sums), octree_splat::pool(from, gpu::Sampling::nearest),
         octree_splat::poolImage(result.radiance), OctreeBinding(result.tree, result.poolShift)},
        result.tree, result.tree.depth + 1, VoxelOctree::kBrickVoxels);
  }

  static glm::ivec3 poolSize(const gpu::Texture& pool) {
    return {pool.description().width, pool.description().height, pool.description().depth};
  }
  static glm::ivec3 sizeOf(const gpu::Texture& map, int level) {
    const gpu::TextureDescription& size = map.description();
    return {std::max(size.width >> level, 1), std::max(size.height >> level, 1), size.depth};
  }
  static std::uint64_t countOf(const glm::ivec3& size) {
    return GridPlacement{.resolution = size}.voxelCount();
  }

  /// The leaf of each photon, and the lowest common ancestors of neighbours' leaves.
  gpu::TextureRef nodeMap(PassContext& frame, const VoxelOctree& tree, const OctreeBinding& bound) {
    const glm::ivec3 size = sizeOf(*photons->position, 0);
    const gpu::TextureRef map = frame.texture({gpu::TextureKind::d2Array, gpu::Format::r32ui, size.x, size.y,
                                               size.z, gpu::fullLevelCount(size.x, size.y)},
                                              "node map");
    frame.dispatchList(frame.program(octree_node_map::kProgram),
                       {octree_node_map::photons(
                            {.gridLow = tree.grid.low, .voxelSize = tree.grid.voxelSize, .mapSize = size}),
                        octree_node_map::photonPosition(photons->position, gpu::Sampling::nearest),
                        octree_node_map::photonNormal(photons->normal, gpu::Sampling::nearest),
                        octree_node_map::pool(octree->radiance, gpu::Sampling::nearest),
                        octree_node_map::nodeMap(map), bound},
                       countOf(size));
    for (int level = 1; level < map->description().levels; ++level) {
      const glm::ivec3 coarse = sizeOf(*map, level), fine = sizeOf(*map, level - 1);
      frame.dispatchList(
          frame.program(octree_node_map_up::kProgram),
          {octree_node_map_up::coarser({.mapSize = coarse, .fine = glm::ivec2(fine), .fineLevel = level - 1}),
           octree_node_map_up::nodes(map, gpu::Sampling::nearest), octree_node_map_up::nodeMap(map, level)},
          countOf(coarse));
    }
    return map;
  }

  static void markLit(PassContext& frame, const gpu::Texture& nodes, const OctreeBinding& bound,
                      const gpu::BufferRef& lit) {
    for (int level = 0; level < nodes.description().levels; ++level) {
      const glm::ivec3 size = sizeOf(nodes, level);
      const bool last = level + 1 == nodes.description().levels;
      frame.dispatchList(
          frame.program(octree_lit::kProgram),
          {octree_lit::nodeMapLevel({.mapSize = size,
                                     .level = level,
                                     .coarser = last ? glm::ivec2(0) : glm::ivec2(sizeOf(nodes, level + 1))}),
           octree_lit::nodes(nodes, gpu::Sampling::nearest), octree_lit::lit(lit), bound},
          countOf(size));
    }
  }

  void average(PassContext& frame, int light, const OctreeBinding& bound, const gpu::TextureRef& nodes,
               const gpu::BufferRef& sums) {
    using Variant = octree_photon_sums::Variant;
    const glm::ivec3 size = sizeOf(*photons->position, 0);
    for (const int stage : {Variant::stageCount, Variant::stageAdd})
      frame.dispatchList(
          frame.program(Variant{.stage = stage},
                        octree_photon_sums::Constants{.rule = static_cast<int>(static_cast<Photons>(rule))}),
          {octree_photon_sums::photonsOfLight(
               {.mapSize = size, .light = light, .voxelSize = octree->tree.grid.voxelSize}),
           octree_photon_sums::photonNormal(photons->normal, gpu::Sampling::nearest),
           octree_photon_sums::photonFlux(photons->flux, gpu::Sampling::nearest),
           octree_photon_sums::nodes(nodes, gpu::Sampling::nearest), octree_photon_sums::sums(sums), bound},
          countOf(size));
  }

  static void halve(PassContext& frame, const RadianceOctree& result, int depth, const gpu::BufferRef& lit) {
    const bool facing = result.opacity == RadianceOctree::Opacity::ofVoxel;
    forEachBrick(
        frame,
        frame.program(octree_filter::Variant{.lit = 1}, octree_filter::Constants{.rule = facing ? 0 : 1}),
        {octree_filter::coarse({depth}), octree_filter::lit(lit),
         octree_filter::pool(result.radiance, gpu::Sampling::nearest),
         octree_filter::poolImage(result.radiance), OctreeBinding(result.tree, result.poolShift)},
        result.tree, depth, VoxelOctree::kBrickVoxels);
  }
};

}  // namespace

void addOctreeSplat(TechniqueRegistry& registry) {
  registry.add<OctreeSplatPass>(
      "octree_splat", "Photons of a reflective shadow map into an octree (Crassin et al. 2011, Sec. 6)");
}

}  // namespace lumivox::voxel_cone_tracing
