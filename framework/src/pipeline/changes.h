// Differences between two frames of a scene, and between two scenes.
#pragma once

#include "lumivox/pipeline/pass.h"

namespace lumivox {

/// Between two snapshots of a scene: what moves.
Reads whatChanged(const Scene& scene, const SceneSnapshot& before, const SceneSnapshot& after);

/// Between two scenes, such as a text before and after an edit: what their snapshots do not hold. Cameras and
/// lights without extent are in the snapshots.
Reads whatChanged(const Scene& before, const Scene& after);

}  // namespace lumivox
