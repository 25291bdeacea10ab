// The technique's passes, file by file.
#pragma once

#include "elements/surface_elements.h"
#include "links/element_light.h"
#include "links/element_links.h"
#include "lumivox/plugin/technique.h"

namespace lumivox::implicit_visibility {

void addHierarchy(TechniqueRegistry& registry);
void addElements(TechniqueRegistry& registry);
void addLinks(TechniqueRegistry& registry);
void addIlluminate(TechniqueRegistry& registry);
void addDisplay(TechniqueRegistry& registry);

}  // namespace lumivox::implicit_visibility
