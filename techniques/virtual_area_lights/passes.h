// The technique's passes, file by file.
#pragma once

#include "lumivox/plugin/technique.h"

namespace lumivox::virtual_area_lights {

void addPoints(TechniqueRegistry& registry);

}  // namespace lumivox::virtual_area_lights
