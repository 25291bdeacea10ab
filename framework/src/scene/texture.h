// Reads images as surface textures.
#pragma once

#include <filesystem>
#include <string>

#include "lumivox/base/hash.h"
#include "lumivox/scene/scene.h"

namespace lumivox {

/// An image file as albedo: linear RGB. An image without colours is grey; an alpha channel is not used.
SurfaceTexture readDiffuseTexture(const std::filesystem::path& file, const std::string& name, Hasher& hasher);
/// An image file as coverage: its alpha channel where it has one, its first channel otherwise.
SurfaceTexture readMaskTexture(const std::filesystem::path& file, const std::string& name, Hasher& hasher);

}  // namespace lumivox
