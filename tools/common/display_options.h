// How images are displayed, in every command that makes one or takes a measure that depends on it.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>

#include "lumivox/base/display.h"
#include "lumivox/base/image.h"

namespace lumivox::command {

/// Of an EXR or PNG file: EV at which its scene is displayed.
inline constexpr const char* kExposureAttribute = "lumivox.exposure_ev";
/// How files and options write EV.
std::string exposureNumber(double exposure);

struct DisplayOptions {
  std::string exposure = "auto", tone = name(kShownTone);

  void addTo(CLI::App& app);
  void addExposureTo(CLI::App& app);  ///< alone: of commands that only measure
  void addToneTo(CLI::App& app);
  bool isGiven() const { return exposure != "auto"; }
  /// EV; nothing for auto; of an image that is named, the one that it is shown at. Error otherwise.
  std::optional<double> given() const;
  Tone toneCurve() const { return toneNamed(tone); }
};

/// EV that an image without its scene is shown at, and where it comes from.
struct FoundExposure {
  double exposure = 0.0;
  std::string from;
};

/// That of its header; else of all pixels of the layer `full`, the main layer or `otherwise`, the first of
/// these that is radiance: which of them emit is not known. `file` is named in messages.
FoundExposure exposureOf(const std::filesystem::path& file, const LayeredImage& image,
                         const std::string& otherwise = "");

}  // namespace lumivox::command
