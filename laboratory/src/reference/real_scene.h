// Virtual content and the real scenes that its captures stand for, traced as one.
#pragma once

#include <optional>

#include "lumivox/scene/scene.h"

namespace lumivox::reference {

/// The scene with all objects, lights and media of the scenes that its captures stand for, their objects
/// marked as real (Object::real). What has the same name in both, a mesh's object, a light or a medium, is
/// one thing and stands once, as the virtual scene says. The sky is the virtual scene's, or the real one's
/// where that has none. Nothing where no capture stands for a scene.
std::optional<Scene> withRealScenes(const Scene& scene);

}  // namespace lumivox::reference
