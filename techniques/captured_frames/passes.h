// The technique's passes, one source file each.
#pragma once

#include "captured_frames_port.h"
#include "captured_frames_shaders.h"
#include "lumivox/plugin/technique.h"

namespace lumivox::captured_frames {

void addRead(TechniqueRegistry& registry);
void addLights(TechniqueRegistry& registry);
void addSurfaces(TechniqueRegistry& registry);
void addRelight(TechniqueRegistry& registry);
void addComposite(TechniqueRegistry& registry);

}  // namespace lumivox::captured_frames
