// The grammar of scene texts: the tables from which the checker, `lumivox describe` and the generated
// reference read; and scenes from texts that lie in no file.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lumivox/dsl/schema.h"
#include "lumivox/scene/scene.h"

namespace lumivox {

/// The ranges that texts and command lines share: a time, s, and a coordinate, m, lie within them to both
/// sides. Squares of differences of such numbers still fit into single precision.
inline constexpr double kLongestTime = 1e9, kFarthestPlace = 1e9;

/// The formats of captures, as texts name them.
inline const std::vector<std::string> kCaptureFormats{"tum", "frames", "redwood", "sens", "exr"};

/// One block, `scene NAME { ... }`, with everything that it may contain.
const std::vector<dsl::BlockSpecification>& sceneSpecifications();

/// As loadScene, for a text: `file` names it in messages, and relative paths start beside it.
Scene loadSceneText(std::string text, const std::filesystem::path& file,
                    const SceneLoadOptions& options = {});

}  // namespace lumivox
