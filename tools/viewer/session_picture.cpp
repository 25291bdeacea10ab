// Composes the picture from outputs, ports, references and errors, and reads the values at a pixel.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lumivox/experiment/report.h"
#include "lumivox/measure/exposure.h"
#include "viewer/session.h"

namespace lumivox::viewer {
namespace {

/// The curve for values that are not radiance: srgb instead of filmic, which compresses bright values.
Curve plain(Curve curve) {
  return curve == Curve::filmic ? Curve::srgb : curve;
}

}  // namespace

void Session::compose() {
  if (lastGood_ == nullptr) return;
  const auto imageOfSide = [&](std::size_t side) {
    return side < lastGood_->sides.size() ? outputOf(lastGood_->sides[side].frame, state_.output)
                                          : ImageBuffer{};
  };
  const bool showsPort = state_.port && !lastGood_->port.image.empty();
  const ImageBuffer image = showsPort ? lastGood_->port.image : imageOfSide(0);
  if (image.empty()) {
    picture_ = {};
    return;
  }
  if (state_.exposure) {
    exposure_ = *state_.exposure;
  } else if (const ImageBuffer whole = compositeImage(lastGood_->sides.front().frame); !whole.empty()) {
    exposure_ = displayExposure(whole);
  } else {
    exposure_ = 0.0;
  }
  // Fractions are displayed without exposure.
  const bool fraction = !image.isRadiance() && !state_.exposure;
  const PictureLook look{fraction ? 0.0 : exposure_, fraction ? plain(state_.curve) : state_.curve,
                         flicker_ < kFlickerSeconds, image.isRadiance() ? kRadianceUnit : std::string()};
  const Picture main = showsPort ? portPicture(look) : pictureOf(image, look);
  std::optional<ReferenceLayer> truth;
  if (reference_ != nullptr && !showsPort)
    truth = referenceLayer(reference_->image, layerOf(lastGood_->sides.front(), state_.output));
  const ImageBuffer second = imageOfSide(1);
  const ImageBuffer other = truth ? truth->mean : ImageBuffer{};
  const Picture right = pictureOf(other.empty() ? second : other, look);
  switch (state_.layout) {
    case Layout::picture:
      picture_ = second.empty() || showsPort ? main : besides(main, pictureOf(second, look));
      break;
    case Layout::reference:
      picture_ = other.empty() ? main : right;
      break;
    case Layout::split:
      picture_ = splitPicture(main, right, state_.split);
      break;
    case Layout::sideBySide: {
      Picture all = second.empty() ? main : besides(main, pictureOf(second, look));
      if (!other.empty()) {
        all = besides(all, right);
        all = besides(all, errorPicture(image, other, state_.errorMap));
      }
      picture_ = std::move(all);
      break;
    }
    case Layout::flicker:
      picture_ = flicker_ < kFlickerSeconds || right.empty() ? main : right;
      break;
    case Layout::error: {
      Picture error = errorPicture(image, other, state_.errorMap);
      picture_ = error.empty() ? main : std::move(error);
      break;
    }
  }
}

Picture Session::portPicture(const PictureLook& outputLook) const {
  const PortPicture& port = lastGood_->port;
  PictureLook look = outputLook;
  look.unit = port.unit;
  ImageBuffer values = port.image;
  if (!state_.exposure && port.unit != kRadianceUnit) {
    // The picture's exposure does not apply to other quantities. Of a scalar the largest value is white,
    // colours without a unit are not exposed, and light in another unit gets an exposure of its own.
    const bool light = port.unit.find('W') != std::string::npos;
    if (!light) look.curve = plain(look.curve);
    float largest = 0.0f;
    for (const float value : values.values())
      if (std::isfinite(value)) largest = std::max(largest, std::abs(value));
    look.exposure =
        values.channels() == 1 && largest > 0.0f
            ? std::clamp(-std::log2(static_cast<double>(largest)), -kLargestExposure, kLargestExposure)
        : light                                        ? displayExposure(values)
        : port.unit.empty() && port.brightness.empty() ? outputLook.exposure
                                                       : 0.0;
  }
  // Directions have negative components: -1..1 is mapped to 0..1.
  if (port.isDirection && state_.curve != Curve::falseColour)
    for (float& value : values.values()) value = 0.5f + 0.5f * value;
  Picture picture = pictureOf(values, look);
  if (picture.legends.empty() && values.channels() == 1)
    picture.legends.push_back(
        {fmt::format("grey: 0 to {:.4g} {}", std::exp2(-look.exposure), port.unit), {}});
  if (port.brightness.empty()) return picture;
  return overlaid(picture, port.brightness,
                  pictureOf(outputOf(lastGood_->sides.front().frame, state_.output), outputLook),
                  state_.seeThrough);
}

std::vector<std::string> Session::valuesAt(int x, int y) const {
  std::vector<std::string> lines;
  if (lastGood_ == nullptr || lastGood_->sides.empty()) return lines;
  // Pictures side by side, with gaps, all have the same pixels.
  const bool showsPort = state_.port && !lastGood_->port.image.empty();
  const int width = showsPort ? lastGood_->port.image.width() : lastGood_->wish.width;
  const int pictures = std::max(1, picture_.width / width);
  const int gap = pictures > 1 ? (picture_.width - pictures * width) / (pictures - 1) : 0;
  x %= width + gap;
  if (x >= width) return lines;
  const auto add = [&](const std::string& name, const ImageBuffer& image, const ImageBuffer& variance) {
    if (x < 0 || y < 0 || x >= image.width() || y >= image.height()) return;
    std::string text = name + ":";
    for (int c = 0; c < image.channels(); ++c) {
      text += fmt::format(" {:.4g}", image.at(x, y, c));
      if (variance.sameShape(image))
        text += fmt::format(" ± {:.2g}", std::sqrt(std::max(0.0f, variance.at(x, y, c))));
    }
    lines.push_back(text);
  };
  const RenderedSide& side = lastGood_->sides.front();
  lines.push_back(fmt::format("pixel {} {}", x, y));
  if (state_.port && !lastGood_->port.image.empty())
    add(fmt::format("{}.{} {}", state_.port->pass, state_.port->port, lastGood_->port.shown),
        lastGood_->port.image, {});
  for (const std::string& name : shownOutputs(side.frame)) {
    add(name, outputOf(side.frame, name), {});
    if (reference_ == nullptr) continue;
    if (const auto layer = referenceLayer(reference_->image, layerOf(side, name)))
      add("  reference", layer->mean, layer->variance);
  }
  return lines;
}

}  // namespace lumivox::viewer
