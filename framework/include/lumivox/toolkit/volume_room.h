// Volumes of voxels, or in words what would fit.
#pragma once

#include <string>
#include <vector>

#include "lumivox/pipeline/pass.h"

namespace lumivox {

/// `count` volumes of a size, with all mips or with the finest level alone, of undefined contents. Where they
/// do not fit, nothing of them is taken, and the Error says how many bytes `what` needs, and of sizes halved
/// from it the largest that fits.
std::vector<gpu::TextureRef> roomFor(PassContext& frame, const glm::ivec3& size, int count,
                                     gpu::Format format, const char* label, bool mips,
                                     const std::string& what);

}  // namespace lumivox
