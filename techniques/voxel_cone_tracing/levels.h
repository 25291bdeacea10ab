// Coarser levels of grids from their finest: what the filters do, and injection between two bounces.
#pragma once

#include "directional_grid.h"
#include "lumivox/plugin/technique.h"

namespace lumivox::voxel_cone_tracing {

/// How children make a parent, in the order of filter.comp: seen through along the axis that they face; their
/// plain mean; that mean in one read by the texture's filter.
enum class Opacity { facing, average, trilinear };

/// Fills all levels above the finest, for which the texture has room.
/// `drawn`: by draws without attributes (drawn.h), of all voxels.
void fillLevels(PassContext& frame, RadianceGrid& grid, Opacity opacity, bool drawn = false);
void fillLevels(PassContext& frame, DirectionalRadianceGrid& grid, bool drawn = false);

}  // namespace lumivox::voxel_cone_tracing
