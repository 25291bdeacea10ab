// Differences between two frames of a scene, and between two scenes.
#pragma once

#include "lumivox/pipeline/pass.h"

namespace lumivox {

/// Changes between two snapshots of a scene: motion, lights, camera, time.
Reads whatChanged(const Scene& scene, const SceneSnapshot& before, const SceneSnapshot& after);

/// Changes between two scenes, such as a text before and after an edit, in parts that snapshots do not hold.
/// Cameras and lights without extent are in snapshots.
Reads whatChanged(const Scene& before, const Scene& after);

}  // namespace lumivox
