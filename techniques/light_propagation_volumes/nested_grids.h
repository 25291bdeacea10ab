// Common parts of all stages: where the nested grids lie, and textures of their cells.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "light_propagation_volumes_shaders.h"
#include "lumivox/plugin/technique.h"
#include "lumivox/toolkit/bindings.h"
#include "lumivox/toolkit/grid_placement.h"
#include "lumivox/toolkit/sh_grid.h"
#include "occluded_faces.h"

namespace lumivox::light_propagation_volumes {

inline constexpr int kBrick = 4;  // cells along a side of a brick, see propagate.comp

/// The grids, finest first. Without an extent the coarsest holds the scene, and the finer ones lie around the
/// camera, but no further out than the scene: what the camera cannot reach needs no cells. With an extent all
/// lie around the camera. All are moved by whole cells.
std::vector<GridPlacement> placeGrids(const SceneSnapshot& snapshot, int levels, int resolution,
                                      float finestExtent);

/// One volume for each colour channel.
using Channels = std::array<gpu::TextureRef, 3>;

/// Coefficients, rgba32f.
Channels coefficientTextures(PassContext& frame, const glm::ivec3& resolution, const std::string& label);

/// Names of the bindings of all channels: to be read, written, summed up, and of the next coarser grid.
inline constexpr std::array<const char*, 3> kRgb{"red", "green", "blue"},
    kNext{"redNext", "greenNext", "blueNext"}, kTotal{"redTotal", "greenTotal", "blueTotal"},
    kOutside{"redOutside", "greenOutside", "blueOutside"}, kParts{"partsX", "partsY", "partsZ"},
    kFilled{"filledX", "filledY", "filledZ"};
shader::BindingSet sampled(const Channels& channels, gpu::Sampling sampling,
                           const std::array<const char*, 3>& names = kRgb);
shader::BindingSet images(const Channels& channels, const std::array<const char*, 3>& names = kRgb);
/// Block Cells of cell_grid.glsl.
gpu::ResourceBinding cellsBinding(const GridPlacement& grid);
/// The light of a level, without colour where another technique may have made it so, and its cells.
shader::BindingSet sampled(const ShGrid::Level& level, gpu::Sampling sampling);

/// `occluded` and `moved` of a level; where there are no such faces, which are then never read, another
/// volume in their place.
shader::BindingSet facesOf(const OccludedFaces::Level& faces, const ShGrid::Level& level);

/// The grids of light, finest first.
using NestedGrids = std::span<const ShGrid::Level>;

/// Calls work(i) for each level from the coarsest to the finest: what comes into a grid from outside is in
/// the coarser one.
template <class Work>
void forEachLevel(NestedGrids light, const Work& work) {
  for (std::size_t i = light.size(); i-- > 0;) work(i);
}

/// Light that is the flux of its cells in W/sr; other light is refused, and such as is not in all cells.
NestedGrids fluxIn(const In<ShGrid>& light);
/// Refuses light without faces for all of its levels: without them it is not known what surfaces occlude.
void requireFaces(NestedGrids light, const In<OccludedFaces>& faces);
/// Refuses light without the packed voxels that it was injected from.
void requirePackedVoxels(NestedGrids light, const In<OccludedFaces>& faces);

/// Each registers the passes of its file.
void addInject(TechniqueRegistry& registry);
void addPropagate(TechniqueRegistry& registry);
void addGather(TechniqueRegistry& registry);

}  // namespace lumivox::light_propagation_volumes
