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

ComparablePair comparable(const Picture& picture, const Picture& truth) {
  if (!picture.sameShape(truth)) {
    throw Error(
        fmt::format("pictures of different shapes cannot be compared: {} x {} pixels with {} channels "
                    "against a truth of {} x {} with {}",
                    picture.width(), picture.height(), picture.channels(), truth.width(), truth.height(),
                    truth.channels()));
  }
  if (picture.empty()) throw Error("empty pictures cannot be compared");
  const auto channels = static_cast<std::size_t>(radianceChannels(truth, "the truth"));
  const auto stride = static_cast<std::size_t>(truth.channels());
  ComparablePair pair;
  pair.picture = Picture(truth.width(), truth.height(), static_cast<int>(channels));
  pair.truth = pair.picture;
  pair.counts.assign(truth.pixelCount(), 1);
  const auto finite = [](float value) { return std::isfinite(value); };
  for (std::size_t pixel = 0; pixel < truth.pixelCount(); ++pixel) {
    const float* a = picture.values().data() + pixel * stride;
    const float* t = truth.values().data() + pixel * stride;
    const bool goodPicture = std::all_of(a, a + channels, finite),
               goodTruth = std::all_of(t, t + channels, finite);
    pair.nonFinitePicture += goodPicture ? 0 : 1;
    pair.nonFiniteTruth += goodTruth ? 0 : 1;
    pair.counts[pixel] = goodPicture && goodTruth ? 1 : 0;
    float* pictureOut = pair.picture.values().data() + pixel * channels;
    float* truthOut = pair.truth.values().data() + pixel * channels;
    if (goodPicture) std::copy_n(a, channels, pictureOut);
    if (goodTruth) std::copy_n(t, channels, truthOut);
    if (!goodPicture && goodTruth) std::copy_n(t, channels, pictureOut);
    if (goodPicture && !goodTruth) std::copy_n(a, channels, truthOut);
  }
  return pair;
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
