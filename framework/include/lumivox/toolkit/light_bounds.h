// Bounds on what the brightest thing of a scene can be, for units in which sums of it fit into integers and
// half floats.
#pragma once

#include "lumivox/scene/scene.h"

namespace lumivox {

/// What no surface can reflect diffusely: all lights at this distance, nearer than which the asker does not
/// look, and the brightest emitter before it, W/(sr m^2). Above 0.
float largestRadiance(const Scene& scene, const SceneSnapshot& snapshot, float nearest);

/// The largest flux that the surfaces of the scene can reflect: all that its lights emit towards it, W, in
/// the brightest channel; above 0.
float largestFlux(const Scene& scene, const SceneSnapshot& snapshot);

}  // namespace lumivox
