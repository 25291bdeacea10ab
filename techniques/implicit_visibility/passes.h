// The technique's passes, file by file.
#pragma once

#include "lumivox/plugin/technique.h"

namespace lumivox::implicit_visibility {

void addHierarchy(TechniqueRegistry& registry);
void addElements(TechniqueRegistry& registry);
void addLinks(TechniqueRegistry& registry);
void addIlluminate(TechniqueRegistry& registry);
void addDisplay(TechniqueRegistry& registry);

}  // namespace lumivox::implicit_visibility
