// What differs between two frames of a scene.
#pragma once

#include "lumivox/pipeline/pass.h"

namespace lumivox {

Reads whatChanged(const Scene& scene, const SceneSnapshot& before, const SceneSnapshot& after);

}  // namespace lumivox
