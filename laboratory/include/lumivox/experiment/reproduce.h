// Published tables and figures measured here.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "lumivox/gpu/device.h"
#include "lumivox/plugin/loader.h"
#include "lumivox/results/reproduction.h"
#include "lumivox/results/store.h"

namespace lumivox {

/// Sorted *.reproduction files of the folder `reproductions` among the committed scenes; none without such a
/// folder.
std::vector<std::filesystem::path> committedReproductions();

struct ReproduceOptions {
  double scale = 0.0;  ///< of image sides and scaled parameters, above 0 to 1; 0: the table's own
  int repeats = 5;     ///< timed frames; those of all rows take turns
  std::uint64_t seed = 1;
  int referenceSamples = 0;  ///< per pixel, for the errors that go to a store; 0: referenceSamplesFor()
  std::vector<std::string> repeatArguments;  ///< further options that a repeating command needs
  /// Told after every step: a set-up's warm-up, its timed frames, what a store takes of it, a panel. The time
  /// left is NaN: as the steps before.
  std::function<void(std::size_t done, std::size_t total, double secondsLeft)> progress;
};

/// Measures every row and point whose set-up is here, and renders every panel. An absent model or technique
/// and a pass that the scene does not need make a row not comparable. `store`: takes every set-up that was
/// timed as a sweep would store it: its times, and then, apart from them, its errors and the work of its
/// passes. Throws DiagnosticsError for a wrong text.
ReproducedResult reproduce(gpu::Device& device, TechniqueSet& techniques, const PublishedResult& published,
                           const ReproduceOptions& options,
                           const std::function<Scene(const std::filesystem::path&)>& loadScene,
                           ResultsStore* store = nullptr);

}  // namespace lumivox
