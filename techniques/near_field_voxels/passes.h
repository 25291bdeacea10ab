// The passes of the technique.
#pragma once

#include "lumivox/plugin/technique.h"
#include "lumivox/toolkit/bindings.h"
#include "lumivox/toolkit/voxel_rays.h"

namespace lumivox::near_field_voxels {

void addProbe(TechniqueRegistry& registry);
void addGather(TechniqueRegistry& registry);

}  // namespace lumivox::near_field_voxels
