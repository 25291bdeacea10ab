// Numbers by which claims about images are judged.
#pragma once

#include <cstddef>
#include <vector>

#include "lumivox/base/image.h"
#include "lumivox/results/reproduction.h"

namespace lumivox::experiment {

/// The numbers of all pixels of an image, row by row from 0; or of its darkest quarter, at least one.
std::vector<std::size_t> comparedPixels(const ImageBuffer& image, bool darkest);

/// What an image has of a quantity in these pixels. Not finite where a pixel is not; colour and detail, which
/// are relative, neither where all is black.
double claimedValue(const ImageBuffer& image, const std::vector<std::size_t>& pixels,
                    ClaimedQuantity quantity);

}  // namespace lumivox::experiment
