// The technique's passes with files of their own.
#pragma once

#include "lumivox/plugin/technique.h"

namespace lumivox::reflective_shadow_maps {

void addChoose(TechniqueRegistry& registry);

}  // namespace lumivox::reflective_shadow_maps
