// The time to measure the default point of each committed pipeline: seconds, their parts, and their ratio to
// the allowance of 12 frames and a second. Work is counted only with --work.
// usage: bench_point_cost [--quick | [--work] [PIPELINE...]] (default: all that suit scenes/cornell.scene, at
// 128 x 128), from the project's folder. --quick: seconds of work, whose figures mean nothing, for the tests.
#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "experiment/measurer.h"
#include "experiment/plan.h"
#include "lumivox/base/error.h"
#include "lumivox/plugin/loader.h"

namespace {

using namespace lumivox;
using namespace lumivox::experiment;
namespace fs = std::filesystem;

/// A temporary folder for a results store.
class Folder {
 public:
  Folder() : path_(fs::temp_directory_path() / fmt::format("lumivox_point_cost_{}", getpid())) {
    fs::create_directory(path_);
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

void measureOne(Measurer& measurer, const LoadedPipeline& loaded, TechniqueSet& techniques,
                const ReportOptions& options) {
  for (const PlannedPoint& planned : pointsFor(loaded, techniques, options)) {
    const WantedPoint wanted{&loaded, planned};
    const StoredRun run = measurer.measure({wanted}).front();
    const std::string name = fs::path(loaded.shown).stem().string();
    if (!run.point.failure.empty()) {
      fmt::print("{:<40}failed: {}\n", name, run.point.failure);
      continue;
    }
    constexpr double kFrames = 12.0, kSeconds = 1.0;
    const double frame = run.point.frameMs.median / 1000.0, took = measurer.secondsOf(wanted);
    std::string parts;
    for (const auto& [what, seconds] : measurer.partsOf(wanted))
      parts += fmt::format("{}{} {:.2f}", parts.empty() ? "" : ", ", what, seconds);
    fmt::print("{:<40}{:>8.3f} s {:>7.2f} s {:>6.2f}  {}\n", name, frame, took,
               took / (kFrames * frame + kSeconds), parts);
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    ReportOptions options;
    options.openSweeps = false;
    options.budgetSeconds = 1e9;  // within a budget, work is not counted
    std::vector<fs::path> files;
    for (int i = 1; i < argc; ++i) {
      const std::string_view word = argv[i];
      if (word == "--quick") {
        options.width = options.height = 16;
        options.referenceSamples = 4;
        files = {"scenes/pipelines/direct_lighting.pipeline"};
      } else if (word == "--work") {
        options.budgetSeconds = 0.0;
      } else {
        files.emplace_back(word);
      }
    }
    if (files.empty()) files = pipelinesIn("scenes/pipelines");
    gpu::Device device;
    TechniqueSet techniques(TechniqueSet::defaultDirectories({}));
    const Scene scene = loadScene("scenes/cornell.scene", {});
    const Folder folder;
    ResultsStore store(folder.path() / "points.sqlite");
    fmt::print("{:<40}{:>10} {:>9} {:>6}  parts, s\n", "pipeline", "frame", "point", "ratio");
    for (const fs::path& file : files) {
      const LoadedPipeline loaded = withSettings(Pipeline::load(file), {});
      if (!whyUnsuited(loaded.pipeline, techniques, SceneTraits::of(scene)).empty()) continue;
      Measurer measurer(device, techniques, options, store, scene, "scenes/cornell.scene");
      measureOne(measurer, loaded, techniques, options);
    }
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_point_cost: {}\n", error.what());
    return 1;
  }
}
