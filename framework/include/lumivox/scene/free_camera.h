// Snapshots of a scene through a camera that is not one of its own.
#pragma once

#include "lumivox/scene/scene.h"

namespace lumivox {

/// The camera as it is at a time, s: its place, target, up and fov by keys and rigid motion, without either.
/// A camera of a capture stays as it is.
Camera cameraAt(const Camera& camera, double time);

/// As snapshotOf(), through `camera`. Error when it looks nowhere: eye and target are one point, or it looks
/// along its own up.
SceneSnapshot snapshotFrom(const Scene& scene, double time, const Camera& camera, int width = 0,
                           int height = 0);

}  // namespace lumivox
