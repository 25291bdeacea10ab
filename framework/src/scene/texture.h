// Reads images as surface textures.
#pragma once

#include <filesystem>
#include <string>

#include "lumivox/base/hash.h"
#include "lumivox/base/image.h"
#include "lumivox/scene/scene.h"

namespace lumivox {

/// Reads an image file; its bytes go into `hasher`.
ByteImage readHashedImage(const std::filesystem::path& file, Hasher& hasher);

/// An image as albedo: linear RGB. An image without colours is grey; an alpha channel is not used.
SurfaceTexture diffuseTextureOf(const ByteImage& image, const std::string& name);
/// An image as coverage: its alpha channel where it has one; otherwise its first channel, or 1 everywhere if
/// only alpha counts.
SurfaceTexture maskTextureOf(const ByteImage& image, const std::string& name, bool byAlphaOnly);

}  // namespace lumivox
