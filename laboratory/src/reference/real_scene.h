// Merges virtual content with the real scenes that its captures stand for.
#pragma once

#include <optional>

#include "lumivox/scene/scene.h"

namespace lumivox::reference {

/// The scene with all objects, lights and media of the scenes that its captures stand for; their objects are
/// marked as real (Object::real). An object, light or medium with the same name in both scenes is taken once,
/// from the virtual scene. The environment is the virtual scene's, or else the real one's. Returns nothing if
/// no capture stands for a scene.
std::optional<Scene> withRealScenes(const Scene& scene);

/// Whether this scene, or one that a capture of it stands for, has an environment: references of it have the
/// layers of kEnvironmentLayers.
bool hasEnvironment(const Scene& scene);

}  // namespace lumivox::reference
