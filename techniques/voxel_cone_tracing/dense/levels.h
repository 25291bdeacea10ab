// Coarser levels of grids from their finest: what the filters do, and injection between two bounces.
#pragma once

#include "lumivox/pipeline/ports/directional_radiance_grid.h"
#include "lumivox/plugin/technique.h"

namespace lumivox::voxel_cone_tracing {

/// The size of a grid with voxels added at its high ends so that halving it leaves no odd number above the
/// few voxels of the coarsest levels. A level that is not of half the size of the finer one has voxels that
/// share children, and an opaque child makes both opaque: walls grow thicker from level to level.
glm::ivec3 evenlyHalved(const glm::ivec3& size);

/// How children make a parent, in the order of filter.comp: seen through along the axis that they face; or
/// their plain mean.
enum class Opacity { facing, average };

/// Fills all levels above the finest, for which the texture has room.
/// `onlyChanges`: the levels hold what they did before grid.changed, and the next two above the finest are
/// made anew only there.
void fillLevels(PassContext& frame, RadianceGrid& grid, Opacity opacity, bool onlyChanges = false);
void fillLevels(PassContext& frame, DirectionalRadianceGrid& grid, bool onlyChanges = false);

/// Whether the pass that runs made the levels of the run before, so that only what has changed differs.
bool continuesLevels(PassContext& frame, const ChangedBricks& changed);

}  // namespace lumivox::voxel_cone_tracing
