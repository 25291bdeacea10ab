// From a texture to a picture in main memory.
#include <fmt/format.h>

#include <algorithm>
#include <cassert>

#include "lumivox/base/error.h"
#include "lumivox/pipeline/pipeline.h"

namespace lumivox {

Picture neutralPicture(int width, int height, Contributes component) {
  Picture picture(width, height, channelsOf(component));
  std::fill(picture.values().begin(), picture.values().end(), neutralElement(component));
  return picture;
}

Picture pictureOf(const gpu::Texture& texture, int channels) {
  const gpu::TextureDescription& description = texture.description();
  assert(description.kind == gpu::TextureKind::d2 && channels > 0);
  Picture picture(description.width, description.height, channels);
  const std::vector<float> texels = texture.downloadFloats(0);
  const std::size_t components = texels.size() / picture.pixelCount();
  if (components < static_cast<std::size_t>(channels)) {
    throw Error(fmt::format("texture '{}' has {} components, but a picture of {} channels is wanted",
                            texture.label(), components, channels));
  }
  for (std::size_t pixel = 0; pixel < picture.pixelCount(); ++pixel) {
    const auto first = texels.begin() + static_cast<std::ptrdiff_t>(pixel * components);
    std::copy_n(
        first, channels,
        picture.values().begin() + static_cast<std::ptrdiff_t>(pixel * static_cast<std::size_t>(channels)));
  }
  return picture;
}

}  // namespace lumivox
