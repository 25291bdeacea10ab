// Models of PLY files, the format of scans: ASCII and binary of both byte orders.
#pragma once

#include "scene/model.h"

namespace lumivox {

/// Reads one PLY file: one object without a name. Vertices have x y z, and may have nx ny nz, texture
/// coordinates (s t, u v, texture_u texture_v) and colours (red green blue, sRGB bytes or linear floats).
/// Faces are polygons, cut as fans. The mean of the colours is the albedo of the one material; without
/// colours it is grey.
Model loadPlyModel(const std::filesystem::path& file, const ModelOptions& options, Hasher& hasher);

}  // namespace lumivox
