// Time ratios of the choices of imperfect volumes, on `cornell` and `arcade`: only voxels that are read over
// all, branchless march over early exit, every voxel of a ray over steps, openness over a bounce, six
// neighbours over eight, half floats over floats. Also the share of a frame's time that scales with pixels,
// and light that propagates from cell to cell over light that rays gather. Times are taken in turns within
// each frame; printed are medians and quartiles of ratios.
// usage: bench_imperfect_volumes [--quick | SIZE [REPEATS [RAYS [VOXELS]...]]] (default: 256 5 100 32 64
// 128), from the project's folder.
// --quick: seconds of work, whose figures mean nothing, for the tests
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
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

namespace {

using namespace lumivox;

std::string inWords(const Spread& spread) {
  return fmt::format("{:.3g} [{:.3g}, {:.3g}]", spread.median, spread.lower, spread.upper);
}

using Times = std::map<std::string, double>;  ///< ms by pass

/// The times of `repeats` frames after one of warm-up. Every pass runs in each frame.
std::vector<Times> timesOf(PipelineExecutor& executor, int repeats) {
  std::vector<Times> result;
  for (int repeat = -1; repeat < repeats; ++repeat) {
    executor.invalidate();
    executor.render(0.0, 0, PipelineExecutor::Images::no, PipelineExecutor::Timing::passes);
    for (const std::vector<PassRecord>& frame : executor.timedPasses()) {
      if (repeat < 0) continue;
      result.emplace_back();
      for (const PassRecord& pass : frame) result.back()[pass.name] = pass.deviceMs;
    }
  }
  return result;
}

/// The time of some passes divided by that of others, in each frame.
Spread ratioOf(const std::vector<Times>& frames, const std::vector<std::string>& passes,
               const std::vector<std::string>& over) {
  std::vector<double> ratios;
  for (const Times& frame : frames) {
    double above = 0.0, below = 0.0;
    for (const std::string& pass : passes) above += frame.at(pass);
    for (const std::string& pass : over) below += frame.at(pass);
    ratios.push_back(above / below);
  }
  return spreadOf(ratios);
}
double medianOf(const std::vector<Times>& frames, const std::string& pass) {
  std::vector<double> values;
  for (const Times& frame : frames) values.push_back(frame.at(pass));
  return spreadOf(values).median;
}

// Every choice is an additional pass beside the committed pipeline's, so that all are timed in each frame.
constexpr const char* kChoices = R"(
pipeline "bench" {
  param resolution 64 in 1..512
  param rays 100 in 2..65536
  pass gbuffer direct_lighting.gbuffer { }
  pass shadow direct_lighting.shadow_map { }
  pass points voxelization.points { resolution $resolution  adaptive on }
  pass voxels voxelization.reproject { gbuffer gbuffer  fragments points.fragments }
  pass average voxelization.average { fragments voxels.fragments }
  pass inject imperfect_volumes.inject { fragments voxels.fragments  shadow shadow.depth }
  pass inject_half imperfect_volumes.inject { fragments voxels.fragments  shadow shadow.depth  precision half }
  pass direct direct_lighting.shade { gbuffer gbuffer  shadow shadow.depth }
  pass voxels_lit voxelization.reproject { gbuffer gbuffer  fragments points.fragments  direct direct.radiance }
  pass inject_lit imperfect_volumes.inject { fragments voxels_lit.fragments  shadow shadow.depth }
  pass cones voxel_cone_tracing.inject { fragments voxels.fragments  shadow shadow.depth }
  pass cones_lit voxel_cone_tracing.inject { fragments voxels_lit.fragments  shadow shadow.depth }
)";

struct Choice {
  const char *name, *reflected, *settings;
};
constexpr Choice kMarches[] = {
    {"march", "inject", "gbuffer gbuffer"},
    {"march_all", "inject", "cover all"},
    {"march_branchless", "inject", "gbuffer gbuffer  exit branchless"},
    {"march_exact", "inject", "gbuffer gbuffer  bits average.bits  walk exact"},
    {"march_eight", "inject", "gbuffer gbuffer  voxels eight"},
    {"march_half", "inject_half", "gbuffer gbuffer"},
};
/// Gathers from `march_all`, whose voxels suffice for either choice of neighbours.
constexpr const char* kGathers[] = {"six", "eight"};

void compareChoices(gpu::Device& device, TechniqueSet& techniques, const Scene& scene, const char* name,
                    int size, int repeats, int rays, int resolution) {
  std::string text = kChoices;
  for (const Choice& march : kMarches)
    text += fmt::format(
        "  pass {} imperfect_volumes.march {{ opacity average.opacity  attributes average.attributes  rays $rays\n"
        "    reflected {}.reflected  {} }}\n",
        march.name, march.reflected, march.settings);
  text +=
      "  pass occlude imperfect_volumes.occlude { opacity average.opacity  gbuffer gbuffer  rays $rays }\n";
  for (const char* gather : kGathers)
    text += fmt::format(
        "  pass {0} imperfect_volumes.gather {{ gbuffer gbuffer  incoming march_all.incoming  voxels {0}\n"
        "    opacity average.opacity  attributes average.attributes }}\n"
        "  output {0} {0}.diffuse\n",
        gather);
  const Pipeline pipeline = Pipeline::parse(text + "}\n", "bench.pipeline");
  RenderOptions options;
  options.width = options.height = size;
  options.parameters =
      pipeline.settings({fmt::format("resolution={}", resolution), fmt::format("rays={}", rays)});
  PipelineExecutor executor(device, techniques, scene, pipeline, options);
  for (const Choice& march : kMarches) executor.keepOutput(march.name, "incoming");
  executor.keepOutput("occlude", "visibility");
  executor.keepOutput("inject_lit", "reflected");
  for (const char* cones : {"cones", "cones_lit"}) executor.keepOutput(cones, "radiance");
  const std::vector<Times> frames = timesOf(executor, repeats);
  fmt::print("{}, {} voxels: march {:.1f} ms, six {:.2f} ms\n", name, resolution, medianOf(frames, "march"),
             medianOf(frames, "six"));
  const auto row = [&](const char* what, const std::vector<std::string>& passes,
                       const std::vector<std::string>& over) {
    fmt::print("  {:<44}{}\n", what, inWords(ratioOf(frames, passes, over)));
  };
  row("voxels that are read, over all", {"march"}, {"march_all"});
  row("branchless, over early", {"march_branchless"}, {"march"});
  row("every voxel of a ray, over steps", {"march_exact"}, {"march"});
  row("openness, over a bounce", {"occlude"}, {"march"});
  row("six over eight, gather", {"six"}, {"eight"});
  row("six over eight, march", {"march"}, {"march_eight"});
  // Sec. 3.2: visible surfaces were lit already by the direct light.
  row("light brought along, inject", {"inject_lit"}, {"inject"});
  row("the same with reprojection", {"voxels_lit", "inject_lit"}, {"voxels", "inject"});
  row("the same, cone tracing", {"voxels_lit", "cones_lit"}, {"voxels", "cones"});
  row("half over float, inject and march", {"inject_half", "march_half"}, {"inject", "march"});
  std::fflush(stdout);
}

/// The share of a frame's time that scales with pixels, for the committed pipeline: the slope of a line
/// through the times at two picture sizes.
void comparePictures(gpu::Device& device, TechniqueSet& techniques, const Scene& scene, const char* name,
                     const std::vector<int>& sizes, int repeats, int rays, int resolution) {
  const Pipeline pipeline = Pipeline::load("scenes/pipelines/imperfect_volumes.pipeline");
  std::vector<std::unique_ptr<PipelineExecutor>> executors;
  for (const int size : sizes) {
    RenderOptions options;
    options.width = options.height = size;
    options.parameters =
        pipeline.settings({fmt::format("resolution={}", resolution), fmt::format("rays={}", rays)});
    executors.push_back(std::make_unique<PipelineExecutor>(device, techniques, scene, pipeline, options));
  }
  std::vector<std::vector<double>> whole(sizes.size()), gather(sizes.size()), march(sizes.size());
  for (int repeat = 0; repeat < repeats; ++repeat)
    for (std::size_t i = 0; i < sizes.size(); ++i)
      for (const Times& frame : timesOf(*executors[i], 1)) {
        double sum = 0.0;
        for (const auto& [pass, ms] : frame) sum += ms;
        whole[i].push_back(sum);
        gather[i].push_back(frame.at("gather") / frame.at("march"));
        march[i].push_back(frame.at("march"));
      }
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    fmt::print("{}, {} voxels, {}^2 pixels: frame {:.0f} ms, march {:.0f} ms, gather over march {}", name,
               resolution, sizes[i], spreadOf(whole[i]).median, spreadOf(march[i]).median,
               inWords(spreadOf(gather[i])));
    if (i > 0) {
      // From a line through this picture size and the next smaller one.
      std::vector<double> shares;
      const double pixels = double(sizes[i]) * sizes[i], before = double(sizes[i - 1]) * sizes[i - 1];
      for (std::size_t r = 0; r < whole[i].size(); ++r)
        shares.push_back((whole[i][r] - whole[i - 1][r]) / (1.0 - before / pixels) / whole[i][r]);
      fmt::print(", share of the frame that scales with pixels {}", inWords(spreadOf(shares)));
    }
    fmt::print("\n");
    std::fflush(stdout);
  }
}

/// Light from the same points, propagated and marched (Sec. 4.1), by the committed pipelines with their own
/// settings: times of the passes that differ.
void comparePropagation(gpu::Device& device, TechniqueSet& techniques, const Scene& scene, const char* name,
                        int size, int repeats, const std::vector<std::string>& settings) {
  RenderOptions options;
  options.width = options.height = size;
  std::vector<std::unique_ptr<PipelineExecutor>> executors;
  for (const char* file : {"imperfect_volumes", "imperfect_volumes_propagation"}) {
    const Pipeline pipeline = Pipeline::load(fmt::format("scenes/pipelines/{}.pipeline", file));
    options.parameters = pipeline.settings(settings);
    executors.push_back(std::make_unique<PipelineExecutor>(device, techniques, scene, pipeline, options));
  }
  std::vector<double> ratios;
  for (int repeat = 0; repeat < repeats; ++repeat) {
    const Times marched = timesOf(*executors[0], 1).front(), propagated = timesOf(*executors[1], 1).front();
    ratios.push_back(
        (propagated.at("inject") + propagated.at("propagate") + propagated.at("gather")) /
        (marched.at("average") + marched.at("inject") + marched.at("march") + marched.at("gather")));
  }
  fmt::print("{}, {}^2 pixels, pipelines as committed: propagated over marched {}\n", name, size,
             inWords(spreadOf(ratios)));
}

int numberOf(const char* text) {
  const std::string_view word = text;
  int number = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (error != std::errc() || end != word.data() + word.size() || number < 1)
    throw Error(
        fmt::format("'{}': SIZE, REPEATS, RAYS and VOXELS are whole numbers from 1 on; usage: "
                    "bench_imperfect_volumes [--quick | SIZE [REPEATS [RAYS [VOXELS]...]]]",
                    word));
  return number;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const bool quick = argc > 1 && std::string_view(argv[1]) == "--quick";
    const int size = quick ? 16 : argc > 1 ? numberOf(argv[1]) : 256;
    const int repeats = quick ? 1 : argc > 2 ? numberOf(argv[2]) : 5;
    const int rays = !quick && argc > 3 ? numberOf(argv[3]) : 100;
    std::vector<int> voxels = quick ? std::vector<int>{16} : std::vector<int>{32, 64, 128};
    if (argc > 4 && !quick) {
      voxels.clear();
      for (int i = 4; i < argc; ++i) voxels.push_back(numberOf(argv[i]));
    }
    gpu::Device device;
    TechniqueSet techniques(TechniqueSet::defaultDirectories({}));
    const Scene cornell = loadScene("scenes/cornell.scene"), arcade = loadScene("scenes/arcade.scene");
    fmt::print("{0} x {0} pixels, {1} rays, {2} repeats in turns, median [quartiles], on {3}\n", size, rays,
               repeats, device.info().renderer);
    for (const int resolution : voxels) {
      compareChoices(device, techniques, cornell, "cornell", size, repeats, rays, resolution);
      compareChoices(device, techniques, arcade, "arcade", size, repeats, rays, resolution);
    }
    const std::vector<int> sizes = quick ? std::vector<int>{8, 16} : std::vector<int>{64, 128, 256, 512};
    for (const int resolution : voxels) {
      if (resolution > 64) continue;  // at higher resolutions the march dominates
      comparePictures(device, techniques, cornell, "cornell", sizes, repeats, rays, resolution);
      comparePictures(device, techniques, arcade, "arcade", sizes, repeats, rays, resolution);
    }
    const std::vector<std::string> smallest =
        quick ? std::vector<std::string>{"resolution=16"} : std::vector<std::string>{};
    comparePropagation(device, techniques, cornell, "cornell", size, repeats, smallest);
    comparePropagation(device, techniques, arcade, "arcade", size, repeats, smallest);
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_imperfect_volumes: {}\n", error.what());
    return 2;
  }
  return 0;
}
