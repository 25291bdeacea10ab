// The part of the page that tells bias from noise, and says what flickers.
#pragma once

#include <string>

#include "report/data.h"

namespace lumivox::report {

std::string noiseSection(const SceneRecord& scene);

}  // namespace lumivox::report
