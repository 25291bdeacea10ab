// The float image itself and the sRGB transfer functions.
#include "lumivox/base/image.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <limits>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"

namespace lumivox {

ImageBuffer::ImageBuffer(int width, int height, int channels, float value)
    : width_(width), height_(height), channels_(channels), radiance_(channels != 1) {
  if (width < 1 || height < 1 || channels < 1) {
    throw Error(
        fmt::format("an image of {} x {} pixels with {} channels cannot be made; expected at least 1 of each",
                    width, height, channels));
  }
  const std::uint64_t pixels = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
  const std::uint64_t pixelBytes = static_cast<std::uint64_t>(channels) * sizeof(float);
  const bool overflows = pixels > std::numeric_limits<std::uint64_t>::max() / pixelBytes;
  const std::uint64_t bytes = overflows ? std::numeric_limits<std::uint64_t>::max() : pixels * pixelBytes;
  // Querying the system costs more than a small image.
  constexpr std::uint64_t kAlwaysFitsBytes = std::uint64_t{1} << 20;
  if (bytes > kAlwaysFitsBytes) {
    requireMemory(bytes, fmt::format("an image of {} x {} pixels with {} channels", width, height, channels));
  }
  values_.assign(static_cast<std::size_t>(pixels) * static_cast<std::size_t>(channels), value);
}

// IEC 61966-2-1:1999, Sec. 5.2: a linear piece near black, a shifted power above it.
float srgbToLinear(float encoded) {
  return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

float linearToSrgb(float linear) {
  return linear <= 0.0031308f ? linear * 12.92f : 1.055f * std::pow(linear, 1.0f / 2.4f) - 0.055f;
}

}  // namespace lumivox
