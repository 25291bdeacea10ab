// The gather of our dense grid against Listings 4.11 to 4.13 of the thesis (Gomes 2015) as printed: `arcade`,
// five diffuse cones and a glossy one, 128 voxels. Times are taken in turns within each frame, as medians and
// quartiles; errors are against the path-traced reference.
// usage: bench_voxel_cone_tracing [--quick | SIZE [REPEATS [NAME=VALUE ...]]] (default: 512 11), from the
// project's folder. NAME=VALUE are parameters of scenes/reproductions/004_gather.pipeline for an additional
// row. --quick: seconds of work, whose figures mean nothing, for the tests
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "../spread.h"
#include "lumivox/base/error.h"
#include "lumivox/pipeline/pipeline.h"
#include "lumivox/plugin/loader.h"
#include "lumivox/reference/path_tracer.h"

namespace {

using namespace lumivox;

/// Our gather with some settings; the printed gather, which has none, is timed together with each.
struct Row {
  std::string name;
  std::vector<std::string> assignments;
  std::unique_ptr<PipelineExecutor> executor;
  std::map<std::string, std::vector<double>> times;  ///< ms by pass
  std::vector<double> ratios;                        ///< ours over the printed one in the same frame
  FrameResult last;
};

struct Judged {
  double error;  ///< RMSE over that of leaving this light out, both without the reference's noise
  double mean;   ///< divided by the reference's mean
};
Judged judge(const ImageBuffer& image, const LayeredImage& reference, const std::string& layer) {
  const ImageBuffer& truth = reference.layers.at(layer);
  const ImageBuffer& variance = reference.layers.at(layer + ".variance");
  double difference = 0.0, none = 0.0, noise = 0.0, sum = 0.0, trueSum = 0.0;
  for (int y = 0; y < truth.height(); ++y)
    for (int x = 0; x < truth.width(); ++x)
      for (int c = 0; c < 3; ++c) {
        const double ours = image.at(x, y, c), theirs = truth.at(x, y, c);
        difference += (ours - theirs) * (ours - theirs);
        none += theirs * theirs;
        noise += variance.at(x, y, c);
        sum += ours;
        trueSum += theirs;
      }
  return {std::sqrt(std::max(difference - noise, 0.0) / std::max(none - noise, 1e-30)), sum / trueSum};
}

void print(const std::string& name, const std::vector<double>& times, const std::vector<double>& ratios,
           const Judged& diffuse, const Judged& glossy) {
  const Spread ms = spreadOf(times);
  const std::string ratio = ratios.empty() ? std::string("1") : [&] {
    const Spread r = spreadOf(ratios);
    return fmt::format("{:.2f} [{:.2f}, {:.2f}]", r.median, r.lower, r.upper);
  }();
  fmt::print("{:<44}{:>7.0f} [{:.0f}, {:.0f}]{:>22}{:>11.3f}{:>7.2f}{:>11.3f}{:>7.2f}\n", name, ms.median,
             ms.lower, ms.upper, ratio, diffuse.error, diffuse.mean, glossy.error, glossy.mean);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const bool quick = argc > 1 && std::string_view(argv[1]) == "--quick";
    const int size = quick ? 32 : argc > 1 ? std::atoi(argv[1]) : 512;
    const int repeats = quick ? 1 : argc > 2 ? std::atoi(argv[2]) : 11;
    if (size < 1 || repeats < 1)
      throw Error(
          "SIZE and REPEATS are numbers from 1; usage: bench_voxel_cone_tracing [--quick | SIZE [REPEATS [NAME=VALUE ...]]]");
    gpu::Device device;
    TechniqueSet techniques(TechniqueSet::defaultDirectories({}));
    const Scene scene = loadScene("scenes/arcade.scene");
    const Pipeline pipeline = Pipeline::load("scenes/reproductions/004_gather.pipeline");
    std::vector<Row> rows;
    const auto add = [&](std::string name, std::vector<std::string> assignments) {
      rows.push_back({std::move(name), std::move(assignments), {}, {}, {}, {}});
    };
    add("ours", {});
    add("one glossy cone, as many cones a pixel", {"glossy_cones=1", "pattern=1"});
    add("steps and voxels of the cone, quarter",
        {"glossy_cones=1", "pixels=quarter", "refinement=1", "step=1"});
    if (!quick && argc > 3) {
      const std::vector<std::string> given(argv + 3, argv + argc);
      add(fmt::format("{}", fmt::join(given, " ")), given);
    }
    for (Row& row : rows) {
      RenderOptions options;
      options.width = options.height = size;
      if (quick) row.assignments.push_back("resolution=16");
      options.parameters = pipeline.settings(row.assignments);
      row.executor = std::make_unique<PipelineExecutor>(device, techniques, scene, pipeline, options);
    }
    for (int repeat = -2; repeat < repeats; ++repeat) {  // two rounds of warm-up
      for (Row& row : rows) {
        row.executor->invalidate();
        const bool last = repeat == repeats - 1;
        row.last =
            row.executor->render(0.0, 0, last ? PipelineExecutor::Images::yes : PipelineExecutor::Images::no,
                                 PipelineExecutor::Timing::passes);
        for (const std::vector<PassRecord>& frame : row.executor->timedPasses()) {
          if (repeat < 0) continue;
          std::map<std::string, double> one;
          for (const PassRecord& pass : frame) one[pass.name] = pass.deviceMs;
          for (const auto& [pass, ms] : one) row.times[pass].push_back(ms);
          row.ratios.push_back(one.at("ours") / one.at("printed"));
        }
      }
    }
    ReferenceOptions options;
    options.width = options.height = size;
    options.samplesPerPixel = quick ? 4 : 64;
    options.progress = false;
    const LayeredImage reference = cachedReference(scene, options);
    fmt::print("arcade, {0} x {0} pixels, {1} repeats in turns, median [quartiles], on {2}\n", size, repeats,
               device.info().renderer);
    fmt::print("{:<44}{:>18}{:>22}{:>18}{:>18}\n", "", "ms", "of the printed one", "diffuse err mean",
               "glossy err mean");
    const auto judged = [&](const Row& row, const std::string& who, const std::string& lobe) {
      return judge(row.last.outputs.at(who + "_" + lobe), reference, "one_bounce_" + lobe);
    };
    std::vector<double> printed;
    for (const Row& row : rows)
      printed.insert(printed.end(), row.times.at("printed").begin(), row.times.at("printed").end());
    print("as printed", printed, {}, judged(rows.front(), "printed", "diffuse"),
          judged(rows.front(), "printed", "glossy"));
    for (const Row& row : rows)
      print(row.name, row.times.at("ours"), row.ratios, judged(row, "ours", "diffuse"),
            judged(row, "ours", "glossy"));
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_voxel_cone_tracing: {}\n", error.what());
    return 2;
  }
  return 0;
}
