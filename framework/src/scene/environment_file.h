// Environment maps from image files.
#pragma once

#include <glm/glm.hpp>
#include <memory>

#include "lumivox/scene/environment.h"
#include "scene/description.h"

namespace lumivox {

/// Reads an OpenEXR or Radiance image as the radiance of the whole sphere, times `scale`. Error names the
/// file and the texel on values that are infinite or no numbers, and on images of more than
/// kMostEnvironmentTexels. Negative values become 0 with a warning, or are refused too if `strict`.
EnvironmentMap readEnvironmentFile(const std::filesystem::path& file, const EnvironmentText& text,
                                   bool strict);

/// A map whose texels are all equal is a constant environment, which costs nothing.
bool isConstant(const EnvironmentMap& map);

}  // namespace lumivox
