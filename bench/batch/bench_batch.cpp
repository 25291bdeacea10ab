// Device memory of a batch of six points of voxel cone tracing, and the memory that they would need without
// sharing; their images and times with and without sharing, taken in turns.
// usage: bench_batch [--quick | SCENE [SIZE [REPEATS [FOLDER OF MODELS]]]] (default: scenes/cornell.scene 128
// 11), from the project's folder. Exit code 1: images differ. --quick: seconds of work, whose times mean
// nothing.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/pipeline/pipeline.h"
#include "lumivox/plugin/loader.h"
#include "pipeline/pool.h"

namespace {

using namespace lumivox;

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

struct Point {
  std::string resolution, cones;
  /// Executors with a resource pool of their own, and with the pool of the batch.
  std::unique_ptr<PipelineExecutor> apart, together;
  std::vector<double> msApart{}, msTogether{}, ratios{};
};

}  // namespace

int main(int argc, char** argv) {
  try {
    const bool quick = argc > 1 && std::string_view(argv[1]) == "--quick";
    const std::string file = quick || argc < 2 ? "scenes/cornell.scene" : argv[1];
    const int size = quick ? 32 : argc > 2 ? std::atoi(argv[2]) : 128;
    const int repeats = quick ? 1 : argc > 3 ? std::atoi(argv[3]) : 11;
    if (size < 1 || repeats < 1) throw Error("SIZE and REPEATS are numbers from 1");
    SceneLoadOptions load;
    if (argc > 4) load.assetPath.emplace_back(argv[4]);
    gpu::Device device;
    TechniqueSet techniques(TechniqueSet::defaultDirectories({}));
    const Scene scene = loadScene(file, load);
    const Pipeline pipeline = Pipeline::load("scenes/pipelines/voxel_cone_tracing.pipeline");
    std::vector<Point> points;
    for (const char* resolution : {"16", "32", "64"})
      for (const char* cones : {"4", "6"}) points.push_back({resolution, cones, nullptr, nullptr});
    const auto memory = std::make_shared<TransientMemory>(device);
    const auto open = [&](const Point& point, std::shared_ptr<TransientMemory> shared) {
      RenderOptions options;
      options.width = options.height = size;
      options.parameters = pipeline.settings({"resolution=" + point.resolution, "cones=" + point.cones});
      options.transientMemory = std::move(shared);
      return std::make_unique<PipelineExecutor>(device, techniques, scene, pipeline, options);
    };
    using Images = PipelineExecutor::Images;
    std::uint64_t alone = 0, shared = 0;
    for (Point& point : points) {
      point.together = open(point, memory);
      point.together->render(0.0, 0, Images::no);
      alone += point.together->memory().bytes;
      shared = point.together->memory().sharedBytes;
    }
    fmt::print("{}, {} x {} pixels, {} points of {}, on {}\n", file, size, size, points.size(), pipeline.name,
               device.info().renderer);
    fmt::print("each with all for itself {}, together {} ({:.0f} %): the scene {} once, waiting {} once\n",
               formatBytes(alone), formatBytes(device.allocatedBytes()),
               100.0 * static_cast<double>(device.allocatedBytes()) / static_cast<double>(alone),
               formatBytes(shared), formatBytes(memory->waitingBytes()));
    for (Point& point : points) point.apart = open(point, nullptr);
    bool same = true;
    for (int repeat = -1; repeat < repeats; ++repeat)  // a round of warm-up
      for (Point& point : points) {
        const auto frame = [&](PipelineExecutor& executor) {
          executor.invalidate();
          return executor.render(0.0, 0, repeat < 0 ? Images::yes : Images::no);
        };
        // The two take turns at coming first.
        FrameResult apart, together;
        if (repeat % 2 == 0) {
          apart = frame(*point.apart);
          together = frame(*point.together);
        } else {
          together = frame(*point.together);
          apart = frame(*point.apart);
        }
        if (repeat >= 0) {
          point.msApart.push_back(apart.frameMs);
          point.msTogether.push_back(together.frameMs);
          point.ratios.push_back(together.frameMs / apart.frameMs);
        }
        for (const auto& [name, image] : apart.outputs)
          same = same && image.values() == together.outputs.at(name).values();
      }
    std::vector<double> ratios;
    for (const Point& point : points) {
      fmt::print("resolution {:>3}, cones {}: {:.1f} ms apart, {:.1f} ms together, ratio {:.3f}\n",
                 point.resolution, point.cones, median(point.msApart), median(point.msTogether),
                 median(point.ratios));
      ratios.insert(ratios.end(), point.ratios.begin(), point.ratios.end());
    }
    const double middle = median(ratios);
    std::vector<double> away;
    for (const double ratio : ratios) away.push_back(std::abs(ratio - middle));
    fmt::print("ratio of frame times, together over apart: median {:.3f}, half of them within {:.3f} of it\n",
               middle, median(away));
    fmt::print("images are {}\n", same ? "the same, bit for bit" : "not the same");
    return same ? 0 : 1;
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_batch: {}\n", error.what());
    return 2;
  }
}
