// Makes coarser levels of grids, for the filters and for injection between two bounces.
#pragma once

#include "lumivox/pipeline/ports/directional_radiance_grid.h"
#include "lumivox/plugin/technique.h"

namespace lumivox::voxel_cone_tracing {

/// The size of a grid with voxels added at its high ends, so that halving leaves no odd number above the few
/// voxels of the coarsest levels. Otherwise voxels of a level share children, and an opaque child makes both
/// opaque: walls become thicker from level to level.
glm::ivec3 evenlyHalved(const glm::ivec3& size);

/// How children make a parent, in the order of filter.comp: composited along the axis that they face, or
/// their plain mean.
enum class Opacity { facing, average };

/// Fills all levels above the finest in the texture. `onlyChanges`: the levels hold their values from before
/// grid.changed, and the two next to the finest are made anew only there.
void fillLevels(PassContext& frame, RadianceGrid& grid, Opacity opacity, bool onlyChanges = false);
void fillLevels(PassContext& frame, DirectionalRadianceGrid& grid, bool onlyChanges = false);

/// Whether the running pass made the levels of the run before, so that only changes differ.
bool continuesLevels(PassContext& frame, const ChangedBricks& changed);

}  // namespace lumivox::voxel_cone_tracing
