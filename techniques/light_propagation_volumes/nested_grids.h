// Common parts of all stages: the placement of nested grids and textures of their cells.
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
/// camera but never beyond the scene, where no cells are needed. With an extent all lie around the camera.
/// All move by whole cells.
std::vector<GridPlacement> placeGrids(const SceneSnapshot& snapshot, int levels, int resolution,
                                      float finestExtent);

/// One volume for each colour channel.
using Channels = std::array<gpu::TextureRef, 3>;

/// Coefficients, rgba32f.
Channels coefficientTextures(PassContext& frame, const glm::ivec3& resolution, const std::string& label);

/// Binding names of all channels: read, written, summed, and those of the next coarser grid.
inline constexpr std::array<const char*, 3> kRgb{"red", "green", "blue"},
    kNext{"redNext", "greenNext", "blueNext"}, kTotal{"redTotal", "greenTotal", "blueTotal"},
    kOutside{"redOutside", "greenOutside", "blueOutside"}, kParts{"partsX", "partsY", "partsZ"},
    kFilled{"filledX", "filledY", "filledZ"};
shader::BindingSet sampled(const Channels& channels, gpu::Sampling sampling,
                           const std::array<const char*, 3>& names = kRgb);
shader::BindingSet images(const Channels& channels, const std::array<const char*, 3>& names = kRgb);
/// Block Cells of cell_grid.glsl.
gpu::ResourceBinding cellsBinding(const GridPlacement& grid);
/// The bindings of a level's light and cells; another technique may have made the light without colour.
shader::BindingSet sampled(const ShGrid::Level& level, gpu::Sampling sampling);

/// The bindings `occluded` and `moved` of a level. Without such faces, which are then never read, another
/// volume is bound.
shader::BindingSet facesOf(const OccludedFaces::Level& faces, const ShGrid::Level& level);

/// The grids of light, finest first.
using NestedGrids = std::span<const ShGrid::Level>;

/// Calls work(i) for each level from the coarsest to the finest, since light enters a grid from the coarser
/// one.
template <class Work>
void forEachLevel(NestedGrids light, const Work& work) {
  for (std::size_t i = light.size(); i-- > 0;) work(i);
}

/// The grids of light that is the intensity of cells, W/sr. Refuses other light, and light that is not in all
/// cells.
NestedGrids fluxIn(const In<ShGrid>& light);
/// Refuses light without faces for all of its levels, which tell what surfaces occlude.
void requireFaces(NestedGrids light, const In<OccludedFaces>& faces);
/// Refuses light without the packed voxels that it was injected from.
void requirePackedVoxels(NestedGrids light, const In<OccludedFaces>& faces);

/// Each function registers the passes of its file.
void addInject(TechniqueRegistry& registry);
void addPropagate(TechniqueRegistry& registry);
void addGather(TechniqueRegistry& registry);

}  // namespace lumivox::light_propagation_volumes
