// The technique's passes, file by file.
#pragma once

#include "lumivox/plugin/technique.h"

namespace lumivox::virtual_area_lights {

void addPoints(TechniqueRegistry& registry);
void addGather(TechniqueRegistry& registry);
void addNormalise(TechniqueRegistry& registry);
void addOcclude(TechniqueRegistry& registry);
void addApply(TechniqueRegistry& registry);
void addBruteForce(TechniqueRegistry& registry);

}  // namespace lumivox::virtual_area_lights
