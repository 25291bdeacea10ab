// The part of a page that shows pictures, truths and error maps.
#pragma once

#include <string>

#include "page/data.h"

namespace lumivox::page {

/// Every truth picture once, as a style, however often it is shown.
std::string truthStyles(const AnalysedReport& data);
/// For each component the pictures beside the truths and their FLIP maps, and any two of them in one frame
/// with a slider between. Needs truthStyles() and kPictureScript.
std::string pictureSection(std::size_t sceneIndex, const AnalysedScene& scene);
extern const char* const kPictureScript;

}  // namespace lumivox::page
