// The surfaces that a camera sees, drawn by whichever pass covers the same pixels at the same depths
// (common/visible_surface.glsl).
#pragma once

#include "lumivox/gpu/device.h"
#include "lumivox/scene/scene.h"

namespace lumivox {

/// World to clip space of a camera, z in [0,1]: for draws with kVisibleSurface.
glm::mat4 worldToClip(const SceneSnapshot& snapshot);

/// Depth is clamped, so that the near plane sets precision alone.
inline constexpr gpu::RasterState kVisibleSurface{.depthTest = true, .depthWrite = true, .depthClamp = true};

}  // namespace lumivox
