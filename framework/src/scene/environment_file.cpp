#include "scene/environment_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lumivox/base/error.h"
#include "lumivox/base/image.h"
#include "lumivox/base/log.h"

namespace lumivox {
namespace {

/// The layer that holds the image: the main one, or the only one.
ImageBuffer imageOf(const std::filesystem::path& file) {
  if (hasFormat(file.string(), {".hdr"})) return readHdr(file, kMostEnvironmentTexels);
  LayeredImage image = readExr(file, kMostEnvironmentTexels);
  auto found = image.layers.find("");
  if (found == image.layers.end() && image.layers.size() == 1) found = image.layers.begin();
  if (found == image.layers.end() || found->second.channels() == 2) {
    std::string names;
    for (const auto& [name, layer] : image.layers) names += (names.empty() ? "" : ", ") + name;
    throw Error(
        fmt::format("{}: has no colours in its main layer (layers: {}); expected channels R, G and B, or Y",
                    file.string(), names));
  }
  return std::move(found->second);
}

}  // namespace

EnvironmentMap readEnvironmentFile(const std::filesystem::path& file, const EnvironmentText& text,
                                   bool strict) {
  const ImageBuffer image = imageOf(file);
  constexpr int kLongestSide = 16384;  // that graphics devices have textures of
  const std::int64_t wide = image.width(), high = image.height();
  if (image.pixelCount() > 1 && (wide > 8 * high || high > 4 * wide || std::max(wide, high) > kLongestSide))
    throw Error(fmt::format("{}: is {} x {} pixels; expected twice as wide as high, and at most {} on a side",
                            file.string(), wide, high, kLongestSide));
  EnvironmentMap map;
  map.width = image.width();
  map.height = image.height();
  map.toMap = glm::mat3(glm::transpose(text.rotation));
  map.radiance.reserve(image.pixelCount());
  std::size_t negative = 0;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      glm::vec3 radiance;
      for (int c = 0; c < 3; ++c)
        radiance[c] =
            static_cast<float>(image.at(x, y, std::min(c, image.channels() == 1 ? 0 : c)) * text.scale);
      const auto refuse = [&](const char* what, const char* expected) {
        throw Error(
            fmt::format("{}: texel {} {} (column and row from the upper left, from 0) is {} ({}, {}, {}); {}",
                        file.string(), x, y, what, radiance.x, radiance.y, radiance.z, expected));
      };
      if (!std::isfinite(radiance.x) || !std::isfinite(radiance.y) || !std::isfinite(radiance.z))
        refuse("not finite", "expected finite radiance, also times 'scale'");
      if (glm::any(glm::lessThan(radiance, glm::vec3(0.0f)))) {
        if (strict) refuse("negative", "expected radiance of at least 0");
        ++negative;
        radiance = glm::max(radiance, glm::vec3(0.0f));
      }
      map.radiance.push_back(radiance);
    }
  }
  if (negative > 0)
    logWarning("{}: {} of {} texels have negative radiance, which counts as 0", file.string(), negative,
               image.pixelCount());
  if (image.width() != 2 * image.height() && image.pixelCount() > 1)
    logWarning(
        "{}: is {} x {} pixels; expected twice as wide as high, since it stands for 360 by 180 degrees",
        file.string(), image.width(), image.height());
  map.finish();
  return map;
}

bool isConstant(const EnvironmentMap& map) {
  return std::all_of(map.radiance.begin(), map.radiance.end(),
                     [&](const glm::vec3& texel) { return texel == map.radiance.front(); });
}

}  // namespace lumivox
