// What the session shows: pictures of outputs, ports, references and errors, and the numbers under a pixel.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lumivox/experiment/report.h"
#include "lumivox/measure/exposure.h"
#include "viewer/session.h"

namespace lumivox::viewer {

void Session::compose() {
  if (lastGood_ == nullptr) return;
  const auto imageOfSide = [&](std::size_t side) {
    return side < lastGood_->sides.size() ? outputOf(lastGood_->sides[side].frame, state_.output)
                                          : ImageBuffer{};
  };
  const bool showsPort = state_.port && !lastGood_->port.empty();
  const ImageBuffer image = showsPort ? lastGood_->port : imageOfSide(0);
  if (image.empty()) {
    picture_ = {};
    return;
  }
  if (state_.exposure) {
    exposure_ = *state_.exposure;
  } else if (!showsPort) {
    const ImageBuffer whole = compositeImage(lastGood_->sides.front().frame);
    exposure_ = whole.empty() ? 0.0 : displayExposure(whole);
  }
  // Fractions are shown as they are.
  const bool fraction = image.channels() == 1 && !state_.exposure;
  const PictureLook look{fraction ? 0.0 : exposure_, state_.curve, flicker_ < kFlickerSeconds};
  const Picture main = pictureOf(image, look);
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

std::vector<std::string> Session::valuesAt(int x, int y) const {
  std::vector<std::string> lines;
  if (lastGood_ == nullptr || lastGood_->sides.empty()) return lines;
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
  if (!lastGood_->port.empty()) add("port", lastGood_->port, {});
  for (const std::string& name : shownOutputs(side.frame)) {
    add(name, outputOf(side.frame, name), {});
    if (reference_ == nullptr) continue;
    if (const auto layer = referenceLayer(reference_->image, layerOf(side, name)))
      add("  reference", layer->mean, layer->variance);
  }
  return lines;
}

}  // namespace lumivox::viewer
