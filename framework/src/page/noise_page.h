// The part of the page that tells bias from noise, and says what flickers.
#pragma once

#include <string>

#include "page/data.h"

namespace lumivox::page {

std::string noiseSection(const AnalysedScene& scene);

}  // namespace lumivox::page
