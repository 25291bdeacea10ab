// Smoke at half and at full resolution, with optical depths to the light from a volume or by marching:
// medians of the passes' times, taken in turns in one run, beside those of the thesis (Gomes 2015, Table 2).
// usage: bench_volumetric_smoke [--quick | SIZE [REPEATS]] (default: 256 11), from the project's folder.
// --quick: seconds of work, whose figures mean nothing, for the tests
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "lumivox/base/error.h"
#include "lumivox/measure/metrics.h"
#include "lumivox/pipeline/pipeline.h"
#include "lumivox/plugin/loader.h"

namespace {

using namespace lumivox;

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

struct Setting {
  const char* name;
  std::vector<std::string> assignments;
  std::unique_ptr<PipelineExecutor> executor;
  std::map<std::string, std::vector<double>> times;  ///< ms by pass
  FrameResult last;

  double ms(const char* pass) const { return median(times.at(pass)); }
};

}  // namespace

int main(int argc, char** argv) {
  try {
    const bool quick = argc > 1 && std::string_view(argv[1]) == "--quick";
    const int size = quick ? 32 : argc > 1 ? std::atoi(argv[1]) : 256;
    const int repeats = quick ? 1 : argc > 2 ? std::atoi(argv[2]) : 11;
    if (size < 1 || repeats < 1)
      throw Error(
          "SIZE and REPEATS are numbers from 1; usage: bench_volumetric_smoke [--quick | SIZE [REPEATS]]");
    gpu::Device device;
    TechniqueSet techniques(TechniqueSet::defaultDirectories({}));
    const Scene scene = loadScene("scenes/smoke.scene");
    const Pipeline pipeline = Pipeline::load("scenes/pipelines/volumetric_smoke.pipeline");
    Setting settings[] = {{"half", {"pixels=half"}, {}, {}, {}},
                          {"full", {"pixels=full"}, {}, {}, {}},
                          {"half, marching to the light", {"pixels=half", "light_depth=march"}, {}, {}, {}}};
    const std::vector<std::string> small = {"resolution=16", "smoke_resolution=16", "steps=4"};
    for (Setting& setting : settings) {
      RenderOptions options;
      options.width = options.height = size;
      options.wanted = {"scattered", "final"};
      if (quick) setting.assignments.insert(setting.assignments.end(), small.begin(), small.end());
      options.parameters = pipeline.settings(setting.assignments);
      setting.executor = std::make_unique<PipelineExecutor>(device, techniques, scene, pipeline, options);
    }
    for (int repeat = -2; repeat < repeats; ++repeat) {  // two rounds of warm-up
      for (Setting& setting : settings) {
        setting.executor->invalidate();
        setting.last = setting.executor->render(
            3.0, 0, repeat == repeats - 1 ? PipelineExecutor::Images::yes : PipelineExecutor::Images::no,
            PipelineExecutor::Timing::passes);
        for (const std::vector<PassRecord>& frame : setting.executor->timedPasses()) {
          if (repeat < 0) continue;
          for (const PassRecord& pass : frame) setting.times[pass.name].push_back(pass.deviceMs);
        }
      }
    }
    fmt::print("{} x {} pixels, median of {} repeats, ms, on {}\n", size, size, repeats,
               device.info().renderer);
    fmt::print("{:<24}{:>10}{:>10}{:>16}{:>16}\n", "", "half", "full", "thesis half", "thesis full");
    const auto row = [&](const char* name, const char* pass, double half, double full) {
      fmt::print("{:<24}{:>10.2f}{:>10.2f}{:>16.2f}{:>16.2f}\n", name, settings[0].ms(pass),
                 settings[1].ms(pass), half, full);
    };
    row("particle update", "particles", 0.21, 0.21);
    fmt::print("{:<24}{:>10.2f}{:>10.2f}\n", "insertion", settings[0].ms("smoke"), settings[1].ms("smoke"));
    row("dithered ray marching", "march", 0.49, 1.80);
    row("bilateral upsampling", "smooth", 1.09, 1.14);
    const double half = settings[0].ms("march") + settings[0].ms("smooth");
    fmt::print("march at full over march at half: {:.2f} (thesis {:.2f})\n",
               settings[1].ms("march") / settings[0].ms("march"), 1.80 / 0.49);
    fmt::print("march and filter at full over the same at half: {:.2f} (thesis {:.2f})\n",
               (settings[1].ms("march") + settings[1].ms("smooth")) / half, (1.80 + 1.14) / (0.49 + 1.09));
    fmt::print("march alone at full over march and upsampling at half: {:.2f}\n",
               settings[1].ms("march") / half);
    fmt::print(
        "march at half with marching to the light {:.2f} ms, {:.2f} times that with light depths in a volume\n",
        settings[2].ms("march"), settings[2].ms("march") / settings[0].ms("march"));
    for (const char* output : {"scattered", "final"}) {
      fmt::print("FLIP of half against full, {}: {:.4f}\n", output,
                 compare(settings[0].last.outputs.at(output), settings[1].last.outputs.at(output)).flip);
    }
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_volumetric_smoke: {}\n", error.what());
    return 2;
  }
  return 0;
}
