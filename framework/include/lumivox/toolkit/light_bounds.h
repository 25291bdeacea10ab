// Bounds on a scene's largest radiance and flux, for units in which their sums fit into integers and half
// floats.
#pragma once

#include "lumivox/scene/scene.h"

namespace lumivox {

/// A bound on diffusely reflected radiance, W/(sr m^2), above 0: all lights at this distance, the smallest
/// that the caller considers, and the brightest emitter nearer than it.
float largestRadiance(const Scene& scene, const SceneSnapshot& snapshot, float nearest);

/// A bound on the flux that the scene's surfaces reflect, W, above 0: all flux that its lights emit towards
/// it, in the brightest channel.
float largestFlux(const Scene& scene, const SceneSnapshot& snapshot);

}  // namespace lumivox
