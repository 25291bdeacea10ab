// Bounds on what the brightest thing of a scene can be, for units in which sums of it fit into integers and
// half floats.
#pragma once

#include "lumivox/scene/scene.h"

namespace lumivox {

/// A bound on diffusely reflected radiance: all lights at this distance, nearer than which the caller does
/// not look, and the brightest emitter nearer than it, W/(sr m^2). Above 0.
float largestRadiance(const Scene& scene, const SceneSnapshot& snapshot, float nearest);

/// The largest flux that the surfaces of the scene can reflect: all that its lights emit towards it, W, in
/// the brightest channel; above 0.
float largestFlux(const Scene& scene, const SceneSnapshot& snapshot);

}  // namespace lumivox
