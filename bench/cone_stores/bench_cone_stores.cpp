// Compares the stores of voxel cone tracing: error, time and bytes on scenes, of which some were used for
// tuning. From the project's folder:
//   bench_cone_stores            measures and prints the tables
//   bench_cone_stores --write    measures, keeps the figures in docs/benchmarks/cone_stores.json, and
//                                rewrites the tables in docs/cones.md
//   bench_cone_stores --cards    writes the tables from the kept figures
//   bench_cone_stores --check    reports whether they differ from the kept figures
//   bench_cone_stores --quick    seconds of work, whose figures mean nothing, for the tests
#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <exception>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/experiment/voxelizers.h"
#include "lumivox/pipeline/pass.h"
#include "lumivox/pipeline/pipeline.h"
#include "lumivox/plugin/loader.h"
#include "lumivox/reference/path_tracer.h"

namespace {

using namespace lumivox;
using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr const char* kKept = "docs/benchmarks/cone_stores.json";
constexpr const char* kGuide = "docs/cones.md";
constexpr const char* kBegin = "<!-- cone stores -->";
constexpr const char* kEnd = "<!-- end -->";

struct Store {
  const char *name, *pipeline;
  const char *pass, *port;                                  ///< the output that holds the filtered store
  const char *besidePass = nullptr, *besidePort = nullptr;  ///< a second output of the store
  int levels = 1;                                           ///< of a clipmap; the coarsest covers the scene
};
constexpr Store kStores[] = {{"one grid", "voxel_cone_tracing", "grid", "mips"},
                             {"with lobes", "voxel_cone_tracing_lobes", "grid", "mips", "sides", "lobes"},
                             {"coarse directional", "voxel_cone_tracing_coarse_directional", "grid", "mips"},
                             {"six grids", "voxel_cone_tracing_directional", "grid", "mips"},
                             {"octree", "voxel_cone_tracing_octree", "bricks", "mips"},
                             {"of six faces", "voxel_cone_tracing_octree_directional", "bricks", "mips"},
                             {"clipmap", "voxel_cone_tracing_clipmap", "grid", "mips", nullptr, nullptr, 2}};
constexpr const char* kScenes[] = {"cornell",
                                   "arcade",
                                   "corridor",
                                   "spinning_box",
                                   "untuned/room",
                                   "untuned/court",
                                   "untuned/turning_corridor"};

struct Size {
  int pixels = 128, voxels = 128, samples = 256, repeats = 3;
};

struct Running {
  const Store* store;
  std::unique_ptr<PipelineExecutor> executor;
  std::map<std::string, std::vector<double>> times;  ///< ms by pass
  FrameResult last;
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// RMSE divided by that of leaving the light out, both without the noise of the reference; and the mean
/// divided by the reference's.
std::pair<double, double> judge(const ImageBuffer& image, const LayeredImage& reference) {
  const ImageBuffer& truth = reference.layers.at("one_bounce_diffuse");
  const ImageBuffer& variance = reference.layers.at("one_bounce_diffuse.variance");
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
  return {std::sqrt(std::max(difference - noise, 0.0) / (none - noise)), sum / trueSum};
}

/// Measures all stores in turns on one scene.
void measure(gpu::Device& device, TechniqueSet& techniques, const std::string& name, const Size& size,
             Json& results) {
  const Scene scene = loadScene("scenes/" + name + ".scene");
  std::vector<Running> all;
  for (const Store& store : kStores) {
    const Pipeline pipeline = Pipeline::load(fmt::format("scenes/pipelines/{}.pipeline", store.pipeline));
    RenderOptions options;
    options.width = options.height = size.pixels;
    options.wanted = {"indirect_diffuse"};
    // The finest voxels of a clipmap, around the camera, are as wide as those of the other stores.
    std::vector<std::string> settings{fmt::format("resolution={}", size.voxels >> (store.levels - 1))};
    if (store.levels > 1) settings.push_back(fmt::format("levels={}", store.levels));
    options.parameters = pipeline.settings(settings);
    all.push_back(
        {&store, std::make_unique<PipelineExecutor>(device, techniques, scene, pipeline, options), {}, {}});
    all.back().executor->keepOutput(store.pass, store.port);
    if (store.besidePass != nullptr) all.back().executor->keepOutput(store.besidePass, store.besidePort);
  }
  for (int repeat = -2; repeat < size.repeats; ++repeat)  // two rounds of warm-up
    for (Running& one : all) {
      one.executor->invalidate();
      one.last = one.executor->render(
          0.0, 0, repeat == size.repeats - 1 ? PipelineExecutor::Images::yes : PipelineExecutor::Images::no,
          PipelineExecutor::Timing::passes);
      for (const std::vector<PassRecord>& frame : one.executor->timedPasses()) {
        if (repeat < 0) continue;
        for (const PassRecord& pass : frame) one.times[pass.name].push_back(pass.deviceMs);
      }
    }
  ReferenceOptions options;
  options.width = options.height = size.pixels;
  options.samplesPerPixel = size.samples;
  options.progress = false;
  const LayeredImage reference = cachedReference(scene, options);
  for (const Running& one : all) {
    const auto [error, mean] = judge(one.last.outputs.at("indirect_diffuse"), reference);
    const OutBase* output = one.executor->output(one.store->pass, one.store->port);
    if (output == nullptr)
      throw Error(fmt::format("{}: no output {}.{}", one.store->pipeline, one.store->pass, one.store->port));
    double build = 0.0;
    for (const auto& [pass, times] : one.times)
      if (pass == "light" || pass == "tree" || pass == one.store->pass ||
          (one.store->besidePass != nullptr && pass == one.store->besidePass))
        build += median(times);
    std::uint64_t bytes = heldBytes(*output);
    if (one.store->besidePass != nullptr)
      bytes += heldBytes(*one.executor->output(one.store->besidePass, one.store->besidePort));
    results.push_back({{"scene", fs::path(name).filename().string()},
                       {"store", one.store->name},
                       {"error", error},
                       {"mean", mean},
                       {"gather_ms", median(one.times.at("gather"))},
                       {"build_ms", build},
                       {"bytes", bytes},
                       {"voxels", opaqueVoxels(*output).value_or(0)}});
  }
}

const Json& resultOf(const Json& results, const std::string& scene, const std::string& store) {
  for (const Json& one : results)
    if (one.at("scene") == scene && one.at("store") == store) return one;
  throw Error(
      fmt::format("{}: nothing of scene '{}' and store '{}'; expected what bench_cone_stores --write keeps",
                  kKept, scene, store));
}

using Cell = std::string (*)(const Json& one, const Json& firstStore);

std::string table(const Json& results, const std::string& what, Cell cell) {
  std::string text = "| " + what + " |", line = "|---|";
  for (const Store& store : kStores) {
    text += fmt::format(" {} |", store.name);
    line += "---|";
  }
  text += "\n" + line + "\n";
  for (const std::string path : kScenes) {
    const std::string scene = fs::path(path).filename().string();
    text += fmt::format("| `{}` |", scene);
    for (const Store& store : kStores)
      text +=
          " " + cell(resultOf(results, scene, store.name), resultOf(results, scene, kStores[0].name)) + " |";
    text += "\n";
  }
  return text + "\n";
}

/// The tables that go between the marks of the guide.
std::string tables(const Json& kept) {
  const Json& results = kept.at("results");
  return fmt::format("\nMeasured on {}, {}, {} voxels along the longest side, {} x {} pixels.\n\n",
                     kept.at("device").get<std::string>(), kept.at("date").get<std::string>(),
                     kept.at("resolution").get<int>(), kept.at("pixels").get<int>(),
                     kept.at("pixels").get<int>()) +
         table(results, "error, mean",
               [](const Json& one, const Json&) {
                 return fmt::format("{:.2f}, {:.2f}", one.at("error").get<double>(),
                                    one.at("mean").get<double>());
               }) +
         table(results, "time of the gather; of the store",
               [](const Json& one, const Json& first) {
                 const auto over = [&](const char* what) {
                   return one.at(what).get<double>() / first.at(what).get<double>();
                 };
                 return fmt::format("{:.2f}; {:.2f}", over("gather_ms"), over("build_ms"));
               }) +
         table(results, "MB; B a voxel", [](const Json& one, const Json&) {
           constexpr double kMegabyte = 1e6;
           const double bytes = one.at("bytes").get<double>();
           return fmt::format("{:.1f}; {:.0f}", bytes / kMegabyte, bytes / one.at("voxels").get<double>());
         });
}

std::string guideWith(const std::string& text) {
  const std::string guide = readFile(kGuide);
  const std::size_t begin = guide.find(kBegin), end = guide.find(kEnd, begin);
  if (begin == std::string::npos || end == std::string::npos)
    throw Error(fmt::format("{}: no place for the tables; expected '{}' and '{}'", kGuide, kBegin, kEnd));
  return guide.substr(0, begin + std::string_view(kBegin).size()) + "\n" + text + guide.substr(end);
}

Json measured(const Size& size) {
  gpu::Device device;
  TechniqueSet techniques(TechniqueSet::defaultDirectories({}));
  Json kept{{"device", device.info().renderer},
            {"date", fmt::format("{:%Y-%m-%d}", fmt::gmtime(std::time(nullptr)))},
            {"resolution", size.voxels},
            {"pixels", size.pixels},
            {"samples", size.samples},
            {"results", Json::array()}};
  for (const char* scene : kScenes) measure(device, techniques, scene, size, kept["results"]);
  return kept;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const std::string_view mode = argc > 1 ? argv[1] : "";
    if (argc > 2 ||
        (!mode.empty() && mode != "--write" && mode != "--cards" && mode != "--check" && mode != "--quick"))
      throw Error("usage: bench_cone_stores [--write | --cards | --check | --quick]");
    if (mode == "--cards" || mode == "--check") {
      const std::string guide = guideWith(tables(Json::parse(readFile(kKept))));
      if (mode == "--cards") {
        writeFileAtomically(kGuide, guide);
      } else if (guide != readFile(kGuide)) {
        fmt::print(stderr, "{}: differs from {}; expected what bench_cone_stores --cards writes\n", kGuide,
                   kKept);
        return 1;
      }
      return 0;
    }
    const Json kept = measured(mode == "--quick" ? Size{16, 16, 4, 1} : Size{});
    if (mode == "--write") {
      writeFileAtomically(kKept, kept.dump(1) + "\n");
      writeFileAtomically(kGuide, guideWith(tables(kept)));
    }
    fmt::print("{}", tables(kept));
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_cone_stores: {}\n", error.what());
    return 2;
  }
  return 0;
}
