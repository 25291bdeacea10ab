#include "common/display_options.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

#include "lumivox/base/error.h"
#include "lumivox/base/log.h"
#include "lumivox/measure/exposure.h"

namespace lumivox::command {
namespace {

namespace fs = std::filesystem;

/// Reads "-1.5" or "-1.5 EV"; nothing for other texts and beyond the largest exposure.
std::optional<double> numberOf(const std::string& text) {
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  std::string unit = end;
  unit.erase(0, unit.find_first_not_of(' '));
  if (end == text.c_str() || (!unit.empty() && unit != "EV") || !(std::abs(number) <= kLargestExposure))
    return std::nullopt;
  return number;
}

/// The exposure, in EV, that a file's header states.
std::optional<double> keptExposure(const fs::path& file,
                                   const std::map<std::string, std::string>& attributes) {
  const auto kept = attributes.find(kExposureAttribute);
  if (kept == attributes.end()) return std::nullopt;
  if (const auto number = numberOf(kept->second)) return number;
  logWarning("{}: its header gives the exposure as '{}', which is no number of EV; it is measured",
             file.string(), kept->second);
  return std::nullopt;
}

double exposureOfFile(const fs::path& file) {
  if (file.extension() == ".exr") return exposureOf(file, readExr(file)).exposure;
  if (const auto kept = keptExposure(file, readPngAttributes(file))) return *kept;
  throw Error(
      fmt::format("{}: tells no exposure; expected a .png that lumivox made, or an .exr", file.string()));
}

}  // namespace

std::string exposureNumber(double exposure) {
  return fmt::format("{:.2f}", exposure);
}

void DisplayOptions::addExposureTo(CLI::App& app) {
  app.add_option(
      "--exposure", exposure,
      "exposure of displayed images: EV (radiance is multiplied by 2^EV); or an .exr or .png, for its exposure; or auto: in a path-traced view of the scene, the log-average luminance of surfaces that do not emit becomes 0.18 (default: auto)");
}

void DisplayOptions::addTo(CLI::App& app) {
  addExposureTo(app);
  addToneTo(app);
}

void DisplayOptions::addToneTo(CLI::App& app) {
  app.add_option("--tone", tone,
                 fmt::format("tone curve of displayed images: linear, srgb or filmic (default: {})",
                             name(kShownTone)))
      ->check(CLI::IsMember({"linear", "srgb", "filmic"}));
}

std::optional<double> DisplayOptions::given() const {
  if (!isGiven()) return std::nullopt;
  if (const auto number = numberOf(exposure)) return number;
  const fs::path file = exposure;
  try {
    if (file.extension() == ".exr" || file.extension() == ".png") return exposureOfFile(file);
  } catch (const Error& error) {
    throw Error(fmt::format("--exposure: {}", error.what()));
  }
  throw Error(
      fmt::format("--exposure '{}': expected auto or a number of EV from {} to {}, as -1.5, or an .exr or "
                  ".png whose exposure is taken",
                  exposure, -kLargestExposure, kLargestExposure));
}

FoundExposure exposureOf(const fs::path& file, const LayeredImage& image, const std::string& otherwise) {
  if (const auto kept = keptExposure(file, image.attributes))
    return {*kept, "the header of " + file.string()};
  for (const std::string& layer : {std::string("full"), std::string(), otherwise}) {
    const auto found = image.layers.find(layer);
    if (found == image.layers.end()) continue;
    if (const int channels = found->second.channels(); channels != 1 && channels != 3 && channels != 4)
      continue;
    return {displayExposure(found->second),
            fmt::format("all pixels of the layer '{}' of {}, which does not tell what emits",
                        layer.empty() ? "main" : layer, file.string())};
  }
  return {0.0, "no layer of radiance is there"};
}

}  // namespace lumivox::command
