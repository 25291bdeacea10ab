// Display options of every command that makes an image, or measures an error that depends on its display.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>

#include "lumivox/base/display.h"
#include "lumivox/base/image.h"

namespace lumivox::command {

/// Attribute of EXR and PNG files: the exposure, in EV, at which the scene is displayed.
inline constexpr const char* kExposureAttribute = "lumivox.exposure_ev";
/// The text of an exposure, in EV, in files and options.
std::string exposureNumber(double exposure);

struct DisplayOptions {
  std::string exposure = "auto", tone = name(kShownTone);

  void addTo(CLI::App& app);
  void addExposureTo(CLI::App& app);  ///< for commands that measure and display nothing
  void addToneTo(CLI::App& app);
  bool isGiven() const { return exposure != "auto"; }
  /// The exposure in EV, of an image file if the option names one; nothing for auto. Error for any other
  /// text.
  std::optional<double> given() const;
  Tone toneCurve() const { return toneNamed(tone); }
};

/// The exposure, in EV, of an image without its scene, and its source in words.
struct FoundExposure {
  double exposure = 0.0;
  std::string from;
};

/// The exposure in the image's header; else that of one layer, computed from all its pixels, since an image
/// does not tell which of them emit. The layer is the first of `full`, the main layer and `otherwise` that
/// has 1, 3 or 4 channels. `file` is named in messages.
FoundExposure exposureOf(const std::filesystem::path& file, const LayeredImage& image,
                         const std::string& otherwise = "");

}  // namespace lumivox::command
