// Quantities of images that claims are judged by.
#pragma once

#include <cstddef>
#include <vector>

#include "lumivox/base/image.h"
#include "lumivox/results/reproduction.h"

namespace lumivox::experiment {

/// Indices of all pixels of an image, row by row from 0; or of its darkest quarter, which is at least one
/// pixel.
std::vector<std::size_t> comparedPixels(const ImageBuffer& image, bool darkest);

/// The value of a quantity over these pixels. It is not finite where a pixel is not; colour and detail are
/// relative, and not finite where all pixels are black.
double claimedValue(const ImageBuffer& image, const std::vector<std::size_t>& pixels,
                    ClaimedQuantity quantity);

}  // namespace lumivox::experiment
