// The passes of the technique.
#pragma once

#include "lumivox/plugin/technique.h"

namespace lumivox::layered_reflective_shadow_maps {

void addLayers(TechniqueRegistry& registry);
void addOcclusion(TechniqueRegistry& registry);
void addGather(TechniqueRegistry& registry);

}  // namespace lumivox::layered_reflective_shadow_maps
