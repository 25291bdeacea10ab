#include "lumivox/base/display.h"

#include <fmt/format.h>

#include <array>

#include "lumivox/base/error.h"
#include "lumivox/base/image.h"

namespace lumivox {
namespace {

constexpr std::array kTones{Tone::linear, Tone::srgb, Tone::filmic};

}  // namespace

const char* name(Tone tone) {
  switch (tone) {
    case Tone::linear:
      return "linear";
    case Tone::srgb:
      return "srgb";
    case Tone::filmic:
      break;
  }
  return "filmic";
}

Tone toneNamed(const std::string& word) {
  for (const Tone tone : kTones)
    if (word == name(tone)) return tone;
  throw Error(fmt::format("'{}' is no tone curve; expected linear, srgb or filmic", word));
}

std::string exposureText(double exposure) {
  return fmt::format("{:+.2f} EV", exposure);
}

float toneMapped(float exposed, Tone tone) {
  if (std::isnan(exposed)) return exposed;
  const float clipped = std::clamp(exposed, 0.0f, 1.0f);
  switch (tone) {
    case Tone::linear:
      return srgbToLinear(clipped);
    case Tone::srgb:
      return clipped;
    case Tone::filmic:
      break;
  }
  return static_cast<float>(FilmicCurve::apply(double{exposed}));
}

}  // namespace lumivox
