// What all stages share: where the nested grids lie, and textures of their cells.
#pragma once

#include <string>
#include <vector>

#include "lumivox/plugin/technique.h"
#include "lumivox/toolkit/grid_placement.h"

namespace lumivox::light_propagation_volumes {

inline constexpr glm::ivec3 kCellGroup{4, 4, 4};   // local size of the passes over cells
inline constexpr glm::ivec3 kImageGroup{8, 8, 1};  // and over pixels
inline constexpr int kBrick = 4;                   // cells along a side of a brick, see propagate.comp

/// The grids, finest first. Without an extent the coarsest holds the scene, and the finer ones lie around the
/// camera, but no further out than the scene: what the camera cannot reach needs no cells. With an extent all
/// lie around the camera. All are moved by whole cells.
std::vector<GridPlacement> placeGrids(const SceneSnapshot& snapshot, int levels, int resolution,
                                      float finestExtent);

/// The largest flux that the surfaces of the scene can reflect: all that its lights emit towards it, W, in
/// the brightest channel; above 0.
float largestFlux(const Scene& scene, const SceneSnapshot& snapshot);

gpu::TextureRef cellTexture(PassContext& frame, const glm::ivec3& resolution, gpu::Format format,
                            const std::string& label);

/// One volume of coefficients for each colour channel, rgba32f.
std::array<gpu::TextureRef, 3> coefficientTextures(PassContext& frame, const glm::ivec3& resolution,
                                                   const std::string& label);

/// For a binding whose texture is read only where there are faces: these, or any other volume in their place.
const gpu::Texture& facesOrUnread(const gpu::TextureRef& faces, const ShGrid::Level& level);

/// Refuses light that no injection pass has made: without faces nobody knows what surfaces close.
void requireFaces(const ShGrid& light);
/// Refuses light without the packed voxels that it was injected from.
void requirePackedVoxels(const ShGrid& light);

/// Each registers the passes of its file.
void addInject(TechniqueRegistry& registry);
void addPropagate(TechniqueRegistry& registry);
void addGather(TechniqueRegistry& registry);

}  // namespace lumivox::light_propagation_volumes
