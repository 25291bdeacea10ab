#include "measure/pixels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lumivox/base/error.h"
#include "lumivox/measure/metrics.h"

namespace lumivox {

int radianceChannels(const Picture& picture, std::string_view what) {
  const int channels = picture.channels();
  if (channels != 1 && channels != 3 && channels != 4) {
    throw Error(fmt::format("{} has {} channels; expected 1, 3 or 4 (radiance, R G B, or R G B and alpha)",
                            what, channels));
  }
  return std::min(channels, 3);
}

double luminanceAt(const Picture& picture, std::size_t pixel) {
  const auto channels = static_cast<std::size_t>(picture.channels());
  const float* values = picture.values().data() + pixel * channels;
  if (channels == 1) return double{values[0]};
  double sum = 0.0;
  for (std::size_t c = 0; c < 3; ++c) sum += kLuminanceWeights[c] * double{values[c]};
  return sum;
}

bool finiteAt(const Picture& picture, std::size_t pixel, int radianceChannels) {
  const float* values = picture.values().data() + pixel * static_cast<std::size_t>(picture.channels());
  return std::all_of(values, values + radianceChannels, [](float value) { return std::isfinite(value); });
}

ComparablePair comparable(const Picture& picture, const Picture& truth) {
  return std::move(comparable(std::span(&picture, 1), truth).front());
}

std::vector<ComparablePair> comparable(std::span<const Picture> pictures, const Picture& truth) {
  if (pictures.empty()) throw Error("at least one picture is needed to compare with a truth");
  for (const Picture& picture : pictures)
    if (!picture.sameShape(truth))
      throw Error(
          fmt::format("pictures of different shapes cannot be compared: {} x {} pixels with {} channels "
                      "against a truth of {} x {} with {}",
                      picture.width(), picture.height(), picture.channels(), truth.width(), truth.height(),
                      truth.channels()));
  if (truth.empty()) throw Error("empty pictures cannot be compared");
  const int channels = radianceChannels(truth, "the truth");
  const auto count = static_cast<std::size_t>(channels), stride = static_cast<std::size_t>(truth.channels());
  ComparablePair blank;
  blank.picture = Picture(truth.width(), truth.height(), channels);
  blank.truth = blank.picture;
  blank.counts.assign(truth.pixelCount(), 1);
  std::vector<ComparablePair> pairs(pictures.size(), blank);
  for (std::size_t pixel = 0; pixel < truth.pixelCount(); ++pixel) {
    const bool goodTruth = finiteAt(truth, pixel, channels);
    // Where the pixel does not count, all have the same: the truth's value, else that of a picture that has
    // one.
    const float* common = goodTruth ? truth.values().data() + pixel * stride : nullptr;
    bool allGood = goodTruth;
    for (std::size_t i = 0; i < pictures.size(); ++i) {
      const bool good = finiteAt(pictures[i], pixel, channels);
      pairs[i].nonFinitePicture += good ? 0 : 1;
      pairs[i].nonFiniteTruth += goodTruth ? 0 : 1;
      if (good && common == nullptr) common = pictures[i].values().data() + pixel * stride;
      allGood = allGood && good;
    }
    for (std::size_t i = 0; i < pictures.size(); ++i) {
      pairs[i].counts[pixel] = allGood ? 1 : 0;
      if (common == nullptr) continue;
      const float* own = allGood ? pictures[i].values().data() + pixel * stride : common;
      std::copy_n(own, count, pairs[i].picture.values().data() + pixel * count);
      std::copy_n(common, count, pairs[i].truth.values().data() + pixel * count);
    }
  }
  return pairs;
}

Picture luminance(const Picture& rgb) {
  radianceChannels(rgb, "a picture whose luminance is wanted");
  Picture result(rgb.width(), rgb.height(), 1);
  for (std::size_t pixel = 0; pixel < rgb.pixelCount(); ++pixel) {
    result.values()[pixel] = static_cast<float>(luminanceAt(rgb, pixel));
  }
  return result;
}

}  // namespace lumivox
