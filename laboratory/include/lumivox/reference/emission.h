// The pixels of an image that show a lamp or the sky, which exposure leaves out.
#pragma once

#include <vector>

#include "lumivox/scene/scene.h"

namespace lumivox {

/// For each pixel of the snapshot's camera, row by row from the top, whether it shows something that shines:
/// 1 where the ray through its centre meets the shining side of an emissive surface, and in the eight pixels
/// around it, since a silhouette is a mixture; 1 where it meets nothing while the environment shines; else 0.
/// Through a lens a pixel shows a lamp where a ray from any of some points of the lens meets one, and the sky
/// where at least half of them meet nothing.
/// Empty when the scene has neither, without any ray. Media are passed through.
std::vector<unsigned char> emittingPixels(const Scene& scene, const SceneSnapshot& snapshot);

}  // namespace lumivox
