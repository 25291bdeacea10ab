#include "measure/pixels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lumivox/base/error.h"
#include "lumivox/measure/metrics.h"

namespace lumivox {

int radianceChannels(const ImageBuffer& image, std::string_view what) {
  const int channels = image.channels();
  if (channels != 1 && channels != 3 && channels != 4) {
    throw Error(fmt::format("{} has {} channels; expected 1, 3 or 4 (radiance, R G B, or R G B and alpha)",
                            what, channels));
  }
  return std::min(channels, 3);
}

double luminanceAt(const ImageBuffer& image, std::size_t pixel) {
  const auto channels = static_cast<std::size_t>(image.channels());
  const float* values = image.values().data() + pixel * channels;
  if (channels == 1) return double{values[0]};
  double sum = 0.0;
  for (std::size_t c = 0; c < 3; ++c) sum += kLuminanceWeights[c] * double{values[c]};
  return sum;
}

bool finiteAt(const ImageBuffer& image, std::size_t pixel, int radianceChannels) {
  const float* values = image.values().data() + pixel * static_cast<std::size_t>(image.channels());
  return std::all_of(values, values + radianceChannels, [](float value) { return std::isfinite(value); });
}

ComparablePair comparable(const ImageBuffer& image, const ImageBuffer& reference) {
  return std::move(comparable(std::span(&image, 1), reference).front());
}

std::vector<ComparablePair> comparable(std::span<const ImageBuffer> images, const ImageBuffer& reference) {
  if (images.empty()) throw Error("at least one image is needed to compare with a reference");
  for (const ImageBuffer& image : images)
    if (!image.sameShape(reference))
      throw Error(
          fmt::format("images of different shapes cannot be compared: {} x {} pixels with {} channels "
                      "against a reference of {} x {} with {}",
                      image.width(), image.height(), image.channels(), reference.width(), reference.height(),
                      reference.channels()));
  if (reference.empty()) throw Error("empty images cannot be compared");
  const int channels = radianceChannels(reference, "the reference");
  const auto count = static_cast<std::size_t>(channels),
             stride = static_cast<std::size_t>(reference.channels());
  ComparablePair blank;
  blank.image = ImageBuffer(reference.width(), reference.height(), channels);
  blank.reference = blank.image;
  blank.counts.assign(reference.pixelCount(), 1);
  std::vector<ComparablePair> pairs(images.size(), blank);
  for (std::size_t pixel = 0; pixel < reference.pixelCount(); ++pixel) {
    const bool goodReference = finiteAt(reference, pixel, channels);
    // A pixel that does not count gets one common value: the reference's, or that of an image with a finite
    // one.
    const float* common = goodReference ? reference.values().data() + pixel * stride : nullptr;
    bool allGood = goodReference;
    for (std::size_t i = 0; i < images.size(); ++i) {
      const bool good = finiteAt(images[i], pixel, channels);
      pairs[i].nonFiniteImage += good ? 0 : 1;
      pairs[i].nonFiniteReference += goodReference ? 0 : 1;
      if (good && common == nullptr) common = images[i].values().data() + pixel * stride;
      allGood = allGood && good;
    }
    for (std::size_t i = 0; i < images.size(); ++i) {
      pairs[i].counts[pixel] = allGood ? 1 : 0;
      if (common == nullptr) continue;
      const float* own = allGood ? images[i].values().data() + pixel * stride : common;
      std::copy_n(own, count, pairs[i].image.values().data() + pixel * count);
      std::copy_n(common, count, pairs[i].reference.values().data() + pixel * count);
    }
  }
  return pairs;
}

ImageBuffer luminance(const ImageBuffer& rgb) {
  radianceChannels(rgb, "an image whose luminance is wanted");
  ImageBuffer result(rgb.width(), rgb.height(), 1);
  for (std::size_t pixel = 0; pixel < rgb.pixelCount(); ++pixel) {
    result.values()[pixel] = static_cast<float>(luminanceAt(rgb, pixel));
  }
  return result;
}

}  // namespace lumivox
