// Volumes of voxels, or an error that says what would fit.
#pragma once

#include <string>
#include <vector>

#include "lumivox/pipeline/pass.h"

namespace lumivox {

/// `count` volumes of a size, with all mips or the finest level alone, with undefined contents. If they do
/// not fit, nothing is allocated, and the Error says how many bytes `what` needs and the largest size, by
/// repeated halving, that fits.
std::vector<gpu::TextureRef> roomFor(PassContext& frame, const glm::ivec3& size, int count,
                                     gpu::Format format, const char* label, bool mips,
                                     const std::string& what);

}  // namespace lumivox
