// Reads textures back as images.
#include <fmt/format.h>

#include <algorithm>
#include <cassert>

#include "lumivox/base/error.h"
#include "lumivox/pipeline/pipeline.h"

namespace lumivox {

ImageBuffer neutralImage(int width, int height, Contributes component) {
  ImageBuffer image(width, height, channelsOf(component));
  std::fill(image.values().begin(), image.values().end(), neutralElement(component));
  return image;
}

ImageBuffer imageOf(const gpu::Texture& texture, int channels) {
  const gpu::TextureDescription& description = texture.description();
  assert(description.kind == gpu::TextureKind::d2 && channels > 0);
  ImageBuffer image(description.width, description.height, channels);
  const std::vector<float> texels = texture.downloadFloats(0);
  const std::size_t components = texels.size() / image.pixelCount();
  if (components < static_cast<std::size_t>(channels)) {
    throw Error(fmt::format("texture '{}' has {} components, but an image of {} channels is wanted",
                            texture.label(), components, channels));
  }
  for (std::size_t pixel = 0; pixel < image.pixelCount(); ++pixel) {
    const auto first = texels.begin() + static_cast<std::ptrdiff_t>(pixel * components);
    std::copy_n(
        first, channels,
        image.values().begin() + static_cast<std::ptrdiff_t>(pixel * static_cast<std::size_t>(channels)));
  }
  return image;
}

ImageBuffer imageOf(const OutBase& output) {
  const std::vector<gpu::TextureRef> textures = output.textures();
  if (textures.empty())
    throw Error(fmt::format("output '{}' of kind {} has no texture", output.name(), output.kind().name));
  // A fraction has one channel.
  const bool one = gpu::componentCount(textures.front()->description().format) < 3;
  ImageBuffer result = imageOf(*textures.front(), one ? 1 : channelsOf(output.contributes()));
  const auto* image = dynamic_cast<const Out<Image>*>(&output);
  if (image != nullptr && !image->value().radiance) result.setRadiance(false);
  return result;
}

}  // namespace lumivox
