#include "viewer/picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "lumivox/measure/metrics.h"

namespace lumivox::viewer {
namespace {

constexpr int kGap = 4;  // pixels between two pictures

Tone toneOf(Curve curve) {
  switch (curve) {
    case Curve::linear:
      return Tone::linear;
    case Curve::filmic:
      return Tone::filmic;
    case Curve::srgb:
    case Curve::falseColour:
      break;
  }
  return Tone::srgb;
}

/// The image with one or three channels, as displayBytes() takes it; missing channels are 0.
ImageBuffer coloursOf(const ImageBuffer& image) {
  if (image.channels() == 1 || image.channels() == 3) return image;
  ImageBuffer colours(image.width(), image.height(), 3);
  for (std::size_t pixel = 0; pixel < image.pixelCount(); ++pixel)
    for (std::size_t c = 0; c < 3; ++c)
      colours.values()[3 * pixel + c] =
          c < static_cast<std::size_t>(image.channels())
              ? image.values()[pixel * static_cast<std::size_t>(image.channels()) + c]
              : 0.0f;
  return colours;
}

Picture framed(const ImageBuffer& image, const Display& display) {
  Picture picture;
  picture.width = image.width();
  picture.height = image.height();
  picture.bytes = displayBytes(image, display);
  return picture;
}

/// The values from `low` to `high` in even steps.
ImageBuffer evenSteps(float low, float high) {
  constexpr int kSteps = 64;
  ImageBuffer map(kSteps, 1, 1);
  for (int i = 0; i < kSteps; ++i)
    map.at(i, 0, 0) = low + (high - low) * static_cast<float>(i) / static_cast<float>(kSteps - 1);
  return map;
}

std::vector<unsigned char> falseColourRamp() {
  return framed(falseColour(evenSteps(0.0f, 1.0f)), {}).bytes;
}

/// Blue below 0 and red above 0, full at an absolute value of 1; NaN if the value is not finite.
void putSigned(float value, float* colour) {
  const float strength = std::min(1.0f, std::abs(value));
  colour[0] = value > 0.0f ? strength : 0.0f;
  colour[1] = 0.0f;
  colour[2] = value < 0.0f ? strength : 0.0f;
  if (!std::isfinite(value)) std::fill_n(colour, 3, std::numeric_limits<float>::quiet_NaN());
}

std::vector<unsigned char> signedRamp() {
  const ImageBuffer map = evenSteps(-1.0f, 1.0f);
  ImageBuffer shown(map.width(), 1, 3);
  for (std::size_t i = 0; i < map.pixelCount(); ++i)
    putSigned(map.values()[i], shown.values().data() + 3 * i);
  return framed(shown, {}).bytes;
}

}  // namespace

Picture pictureOf(const ImageBuffer& given, const PictureLook& look) {
  if (given.empty()) return {};
  ImageBuffer image = coloursOf(given);
  const auto channels = static_cast<std::size_t>(image.channels());
  std::size_t bad = 0;
  for (std::size_t pixel = 0; pixel < image.pixelCount(); ++pixel) {
    const auto first = image.values().begin() + static_cast<std::ptrdiff_t>(pixel * channels);
    if (std::all_of(first, first + static_cast<std::ptrdiff_t>(channels),
                    [](float value) { return std::isfinite(value); }))
      continue;
    ++bad;
    std::fill_n(first, channels, look.marksBadPixels ? std::numeric_limits<float>::quiet_NaN() : 0.0f);
  }
  Picture picture;
  if (look.curve == Curve::falseColour) {
    ImageBuffer map = luminance(image);
    float low = std::numeric_limits<float>::max(), high = std::numeric_limits<float>::lowest();
    for (const float value : map.values())
      if (std::isfinite(value)) low = std::min(low, value), high = std::max(high, value);
    if (low > high) low = high = 0.0f;
    if (low == high) low = std::min(0.0f, low);  // a constant image is shown at the far end of a ramp from 0
    for (float& value : map.values()) value = high > low ? (value - low) / (high - low) : 0.0f * value;
    picture = framed(falseColour(map), {});
    picture.legends.push_back(
        {fmt::format("{} {:.4g} to {:.4g}{}{}", given.channels() == 1 ? "value" : "luminance", low, high,
                     look.unit.empty() || look.unit == "1" ? "" : " ", look.unit == "1" ? "" : look.unit),
         falseColourRamp()});
  } else {
    picture = framed(image, {look.exposure, toneOf(look.curve)});
  }
  picture.badPixels = bad;
  return picture;
}

Picture errorPicture(const ImageBuffer& image, const ImageBuffer& reference, ErrorMap map) {
  if (image.empty() || !image.sameShape(reference)) return {};
  Picture picture;
  if (map == ErrorMap::flip) {
    picture = framed(falseColour(flipHdr(image, reference)), {});
    picture.legends.push_back({"error: HDR-FLIP 0 to 1", falseColourRamp()});
    return picture;
  }
  const ImageBuffer made = luminance(image), truth = luminance(reference);
  double mean = 0.0;
  for (const float value : truth.values()) mean += std::isfinite(value) ? value : 0.0f;
  mean /= static_cast<double>(truth.pixelCount());
  ImageBuffer shown(image.width(), image.height(), 3);
  for (std::size_t pixel = 0; pixel < made.pixelCount(); ++pixel) {
    const float difference = made.values()[pixel] - truth.values()[pixel];
    float* const colour = shown.values().data() + 3 * pixel;
    if (map == ErrorMap::squared) {
      colour[0] = colour[1] = colour[2] = static_cast<float>(difference * difference / (mean * mean + 1e-30));
    } else {
      // In dark pixels of the reference the divisor is a hundredth of its mean, as in the relative error of
      // the report.
      const auto relative =
          static_cast<float>(difference / std::max<double>(truth.values()[pixel], 0.01 * mean + 1e-30));
      putSigned(relative, colour);
    }
  }
  picture = framed(shown, {});
  picture.legends.push_back(
      map == ErrorMap::squared
          ? Legend{fmt::format("error: squared difference 0 to {:.4g}", mean * mean),
                   framed(evenSteps(0.0f, 1.0f), {}).bytes}
          : Legend{"error: -100 % (blue, too dark) to 100 % (red, too bright)", signedRamp()});
  return picture;
}

Picture splitPicture(const Picture& left, const Picture& right, double at) {
  if (left.width != right.width || left.height != right.height) return left.empty() ? right : left;
  Picture picture = left;
  picture.badPixels = left.badPixels + right.badPixels;
  const int column = static_cast<int>(std::lround(std::clamp(at, 0.0, 1.0) * left.width));
  for (int y = 0; y < left.height; ++y) {
    const std::size_t row = 3 * static_cast<std::size_t>(y) * static_cast<std::size_t>(left.width);
    const auto from = static_cast<std::ptrdiff_t>(row + 3 * static_cast<std::size_t>(column));
    std::copy(
        right.bytes.begin() + from,
        right.bytes.begin() + static_cast<std::ptrdiff_t>(row + 3 * static_cast<std::size_t>(left.width)),
        picture.bytes.begin() + from);
    if (column > 0 && column < left.width)
      std::fill_n(picture.bytes.begin() + from, 3, static_cast<unsigned char>(255));
  }
  return picture;
}

Picture overlaid(const Picture& voxels, const ImageBuffer& brightness, const Picture& behind,
                 double seeThrough) {
  Picture picture = voxels;
  const bool hasBehind = behind.width == voxels.width && behind.height == voxels.height;
  for (std::size_t pixel = 0; pixel < brightness.pixelCount(); ++pixel) {
    const auto surface = static_cast<double>(brightness.values()[pixel]);
    const double share = surface > 0.0 ? seeThrough : 1.0;
    for (std::size_t i = 3 * pixel; i < 3 * pixel + 3; ++i) {
      const double back = hasBehind ? behind.bytes[i] : 0.0;
      picture.bytes[i] =
          static_cast<unsigned char>(std::lround((1.0 - share) * surface * voxels.bytes[i] + share * back));
    }
  }
  return picture;
}

Picture besides(const Picture& left, const Picture& right) {
  if (left.empty()) return right;
  if (right.empty()) return left;
  Picture picture;
  picture.width = left.width + kGap + right.width;
  picture.height = std::max(left.height, right.height);
  picture.badPixels = left.badPixels + right.badPixels;
  picture.legends = left.legends;
  for (const Legend& legend : right.legends)
    if (std::ranges::find(left.legends, legend.text, &Legend::text) == left.legends.end())
      picture.legends.push_back(legend);
  picture.bytes.assign(3 * static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height),
                       0);
  const auto put = [&](const Picture& part, int column) {
    for (int y = 0; y < part.height; ++y)
      std::copy_n(part.bytes.begin() + 3 * static_cast<std::ptrdiff_t>(y) * part.width, 3 * part.width,
                  picture.bytes.begin() + 3 * (static_cast<std::ptrdiff_t>(y) * picture.width + column));
  };
  put(left, 0);
  put(right, left.width + kGap);
  return picture;
}

}  // namespace lumivox::viewer
