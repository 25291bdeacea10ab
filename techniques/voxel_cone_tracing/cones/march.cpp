#include "march.h"

#include <fmt/format.h>

#include "../clipmap/clipmap.h"
#include "../dense/levels.h"
#include "../octree/octree.h"
#include "lumivox/base/error.h"
#include "lumivox/toolkit/bindings.h"

namespace lumivox::voxel_cone_tracing {

namespace gather = shaders::voxel_cone_tracing::gather;

namespace {

/// The part of the binding that all stores have; `block` holds the rest of the block Store.
StoreBinding begun(int axis, const GridPlacement& grid, gather::Store block) {
  StoreBinding result;
  block.storeLow = grid.low;
  block.storeVoxel = result.voxel = grid.voxelSize;
  block.storeExtent = glm::vec3(grid.resolution) * grid.voxelSize;
  result.grid = grid;
  result.axis = axis;
  result.length = 2.0f * glm::length(block.storeExtent);
  result.add(shader::UniformSlot<gather::Store>{"Store"}(block));
  return result;
}

}  // namespace

StoreBinding storeOf(const RadianceGrid& grid) {
  StoreBinding result =
      begun(gather::Variant::storeDense, grid.grid,
            {.storeCoarsest = static_cast<float>(grid.radiance->description().levels - 1),
             .storeUnit = grid.unit,
             .storeOpacityOfFinestVoxel = grid.opacity == RadianceGrid::Opacity::ofFinestVoxel});
  result.holdsMedia = grid.holdsMedia;
  result.bounces = grid.bounces;
  result.add(shader::SampledSlot{"radianceGrid"}(grid.radiance, gpu::Sampling::linearMipsBorder));
  return result;
}

StoreBinding storeOf(const DirectionalRadianceGrid& grid, bool layers) {
  StoreBinding result = begun(gather::Variant::storeDirectional, grid.grid,
                              {.storeCoarsest = static_cast<float>(grid.filledLevels - 1),
                               .storeUnit = grid.unit,
                               .storeFirstLevelOfFaces = static_cast<float>(grid.firstLevelOfFaces()),
                               .storeLayers = layers,
                               .storeVoxels = glm::vec3(grid.grid.resolution)});
  result.holdsMedia = grid.holdsMedia;
  const gpu::TextureRef& finest = grid.finest != nullptr ? grid.finest : grid.faces[0];
  result.add(shader::SampledSlot{"finestGrid"}(finest, gpu::Sampling::linearMipsBorder));
  result.add(facesOf(grid.faces, gpu::Sampling::linearMipsBorder));
  return result;
}

StoreBinding storeOf(const RadianceClipmap& clipmap, bool layers) {
  // The box of the coarsest level around the camera, in finest voxels.
  const int coarsest = clipmap.around - 1;
  const VoxelRange& voxels = clipmap.levels[static_cast<std::size_t>(coarsest)].own.voxels;
  const GridPlacement box{clipmap.origin + clipmap.sizeOf(coarsest) * glm::vec3(voxels.first),
                          clipmap.voxelSize, voxels.size() * (1 << coarsest)};
  StoreBinding result = begun(gather::Variant::storeClipmap, box,
                              {.storeCoarsest = static_cast<float>(clipmap.filledLevels - 1),
                               .storeUnit = clipmap.unit,
                               .storeLayers = layers});
  result.add(clipmapBinding(clipmap));
  result.add(facesOf(clipmap.faces, gpu::Sampling::linear));
  return result;
}

StoreBinding storeOf(const RadianceOctree& octree, bool layers) {
  const VoxelOctree& tree = octree.tree;
  // Includes the empty voxels that a dense grid has at its high ends. A wall in the last voxels is read up to
  // half a voxel of every level behind it; a cone that ended at the wall would take half of it for open.
  GridPlacement whole = tree.grid;
  whole.resolution = evenlyHalved(whole.resolution);
  StoreBinding result =
      begun(gather::Variant::storeOctree, whole,
            {.storeCoarsest = static_cast<float>(octree.filledLevels - 1),
             .storeUnit = octree.unit,
             .storeOpacityOfFinestVoxel = octree.opacity == RadianceOctree::Opacity::ofFinestVoxel,
             .storeLayers = layers});
  result.faces = octree.faces > 1 ? gather::Variant::facesSix : gather::Variant::facesOne;
  result.add(shader::SampledSlot{"brickPool"}(octree.radiance, gpu::Sampling::nearest));
  result.add(OctreeBinding(tree, octree.poolShift));
  return result;
}

StoreInput::StoreInput(Pass* pass)
    : grid_(pass, "grid", Presence::optional, "pre-filtered radiance, one mip per halving", Needs::nothing,
            Levels::all),
      directions_(pass, "directions", Presence::optional,
                  "in place of 'grid': pre-filtered radiance of the six faces of voxels", Needs::nothing,
                  Levels::all),
      octree_(pass, "octree", Presence::optional,
              "in place of 'grid': pre-filtered radiance in a sparse voxel octree", Needs::nothing,
              Levels::all),
      clipmap_(pass, "clipmap", Presence::optional,
               "in place of 'grid': pre-filtered radiance in levels around the camera", Needs::nothing,
               Levels::all),
      reading_(
          pass, "reading", Reading::layers,
          "with 'directions', 'clipmap' and an octree with six faces; layers: each face is read in the layer of voxels across its axis, so that walls stay closed; interpolated: all faces are filtered along all axes and averaged, as published") {
}

StoreBinding StoreInput::binding() const {
  const int stores = grid_.present() + directions_.present() + octree_.present() + clipmap_.present();
  if (stores != 1)
    throw Error(fmt::format(
        "voxel_cone_tracing: {} of light for the cones; expected one of the inputs 'grid', 'directions', 'octree' and 'clipmap' to be connected",
        stores == 0 ? "no store" : "several stores"));
  if (grid_.present()) return storeOf(*grid_);
  if (clipmap_.present()) return storeOf(*clipmap_, reading_ == Reading::layers);
  return directions_.present() ? storeOf(*directions_, reading_ == Reading::layers)
                               : storeOf(*octree_, reading_ == Reading::layers);
}

ConeMarch::ConeMarch(Pass* pass)
    : step_(pass, "step", MarchSettings{}.step, within(0.05f, 2.0f),
            "step along a cone as a share of its diameter"),
      offset_(pass, "offset", MarchSettings{}.offset, within(0.0f, 8.0f),
              "distance of a cone's start along the normal, in voxels"),
      start_(pass, "start", MarchSettings{}.start, within(0.0f, 8.0f),
             "distance of a cone's start along its axis, in voxels"),
      clearance_(
          pass, "clearance", MarchSettings{}.clearance, within(0.0f, 1e3f),
          "largest voxel that is read, as a share of its height over the surface; as published: no limit, 1000"),
      footprint_(
          pass, "footprint", MarchSettings{}.footprint, within(0.25f, 1.0f),
          "size of the voxels that are read, as a share of the cone's diameter; as published: 1, which reads a width of twice the cone"),
      refinement_(
          pass, "refinement", MarchSettings{}.refinement, within(0.0f, 1.0f),
          "smallest voxel that is read where voxels are partly covered, as a share of the size for the cone; 1: none smaller; 0: the finest"),
      reach_(pass, "reach", MarchSettings{}.reach, within(0.0f, 1e9f), "m",
             "length of a cone; 0: to the end of the grid"),
      jitter_(
          pass, "jitter", MarchSettings{}.jitter, within(0.0f, 1.0f),
          "largest random reduction of a cone's first step, as a share of it, for each pixel and cone: noise in place of bands") {
}

shader::BindingSet ConeMarch::binding(const PassContext& frame, const StoreBinding& store) const {
  return MarchSettings{step_, offset_, start_, clearance_, footprint_, refinement_, reach_, jitter_}.binding(
      frame, store);
}

shader::BindingSet MarchSettings::binding(const PassContext& frame, const StoreBinding& store) const {
  return {shader::UniformSlot<gather::March>{"March"}({.environment = frame.sceneDescription().environment,
                                                       .maxDistance = reach > 0.0f ? reach : store.length,
                                                       .stepShare = step,
                                                       .offset = offset,
                                                       .startShare = start,
                                                       .clearance = clearance,
                                                       .footprint = footprint,
                                                       .leastShare = refinement,
                                                       .jitter = jitter,
                                                       .seed = seedWords(frame)})};
}

}  // namespace lumivox::voxel_cone_tracing
