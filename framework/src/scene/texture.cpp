#include "scene/texture.h"

#include <array>

#include "lumivox/base/file.h"
#include "lumivox/base/image.h"

namespace lumivox {
namespace {

SurfaceTexture shapedAs(const ByteImage& image, const std::string& name, bool mask) {
  SurfaceTexture texture;
  texture.name = name;
  texture.width = image.width;
  texture.height = image.height;
  texture.mask = mask;
  const std::size_t pixels = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  requireMemory(pixels * (mask ? 1 : 3) * sizeof(float), name);
  texture.values.reserve(pixels * (mask ? 1 : 3));
  return texture;
}

}  // namespace

ByteImage readHashedImage(const std::filesystem::path& file, Hasher& hasher) {
  const std::string bytes = readFile(file, kLargestImageFile);
  hasher.add(bytes);
  return decodeByteImage(bytes, file);
}

SurfaceTexture diffuseTextureOf(const ByteImage& image, const std::string& name) {
  static const std::array<float, 256> linear = [] {
    std::array<float, 256> table{};
    for (std::size_t i = 0; i < table.size(); ++i) table[i] = srgbToLinear(static_cast<float>(i) / 255.0f);
    return table;
  }();
  SurfaceTexture texture = shapedAs(image, name, false);
  const auto channels = static_cast<std::size_t>(image.channels);
  const bool grey = channels < 3;
  for (std::size_t i = 0; i < image.values.size(); i += channels) {
    for (std::size_t c = 0; c < 3; ++c) texture.values.push_back(linear[image.values[i + (grey ? 0 : c)]]);
  }
  return texture;
}

SurfaceTexture maskTextureOf(const ByteImage& image, const std::string& name, bool byAlphaOnly) {
  SurfaceTexture texture = shapedAs(image, name, true);
  const auto channels = static_cast<std::size_t>(image.channels);
  const bool hasAlpha = channels == 2 || channels == 4;
  if (byAlphaOnly && !hasAlpha) texture.values.assign(image.values.size() / channels, 1.0f);
  for (std::size_t i = 0; i < image.values.size() && (hasAlpha || !byAlphaOnly); i += channels) {
    texture.values.push_back(static_cast<float>(image.values[i + (hasAlpha ? channels - 1 : 0)]) / 255.0f);
  }
  return texture;
}

}  // namespace lumivox
