// Propagation in two grids of 32^3 cells over eight iterations: the folded shader beside the one in the
// structure of thesis 004 Listing 4.32, in turns, with the difference of their results. Prints medians.
// usage: bench_light_propagation_volumes [repeats, default 15]
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <random>
#include <vector>

#include "lumivox/pipeline/pipeline.h"
#include "lumivox/plugin/loader.h"

namespace {

using namespace lumivox;

constexpr int kCells = 32, kIterations = 8;

/// Lit surfaces: all cells of the three planes of a corner, everything else empty.
ShGrid cornerOfLight(gpu::Device& device) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> flux(0.5f, 1.0f);
  ShGrid result;
  for (int number = 0; number < 2; ++number) {
    gpu::TextureDescription description;
    description.kind = gpu::TextureKind::d3;
    description.format = gpu::Format::rgba32f;
    description.width = description.height = description.depth = kCells;
    ShGrid::Level level;
    level.grid = {glm::vec3(-1.0f), std::ldexp(1.0f / kCells, number), glm::ivec3(kCells)};
    for (gpu::TextureRef& texture : level.coefficients) {
      std::vector<float> values;
      for (int z = 0; z < kCells; ++z)
        for (int y = 0; y < kCells; ++y)
          for (int x = 0; x < kCells; ++x) {
            const bool lit = x == 1 || y == 1 || z == 1;
            const float light = lit ? flux(random) : 0.0f;
            values.insert(values.end(), {light, y == 1 ? light : 0.0f, z == 1 ? light : 0.0f, 0.0f});
          }
      texture = std::make_shared<gpu::Texture>(device, description, "light");
      texture->uploadFloats(0, values);
    }
    description.format = gpu::Format::rgba8;
    description.width = description.height = description.depth = kCells + 1;
    level.closed = std::make_shared<gpu::Texture>(device, description, "closed faces");
    level.closed->clear(glm::vec4(0.0f));
    result.levels.push_back(level);
  }
  return result;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

void run(int repeats) {
  gpu::Device device;
  TechniqueSet techniques(TechniqueSet::defaultDirectories({LUMIVOX_TECHNIQUES}));
  Scene scene;
  scene.cameras.emplace_back();
  const SceneSnapshot snapshot = snapshotOf(scene, 0.0);
  const ShGrid light = cornerOfLight(device);
  const char* const methods[] = {"plain", "folded"};
  std::vector<std::unique_ptr<PassHarness>> passes;
  for (const char* method : methods) {
    passes.push_back(std::make_unique<PassHarness>(device, techniques, "light_propagation_volumes",
                                                   "propagate", scene, snapshot));
    passes.back()->setParameter("method", std::string(method));
    passes.back()->setParameter("iterations", kIterations);
    passes.back()->setInput("light", light);
    passes.back()->run();  // compiles
  }
  std::vector<double> times[2];
  for (int i = 0; i < repeats; ++i)
    for (std::size_t m = 0; m < 2; ++m) times[m].push_back(device.time([&] { passes[m]->run(); }).deviceMs);
  double difference = 0.0, norm = 0.0;
  for (std::size_t level = 0; level < 2; ++level) {
    std::vector<float> values[2];
    for (std::size_t m = 0; m < 2; ++m)
      values[m] = passes[m]->output<ShGrid>("light").levels[level].coefficients[0]->downloadFloats(0);
    for (std::size_t i = 0; i < values[0].size(); ++i) {
      difference += std::pow(values[0][i] - values[1][i], 2.0);
      norm += std::pow(values[0][i], 2.0);
    }
  }
  fmt::print("{}, two grids of {}^3, {} iterations, {} repeats\n", device.info().renderer, kCells,
             kIterations, repeats);
  for (std::size_t m = 0; m < 2; ++m) fmt::print("{:<8} {:9.2f} ms\n", methods[m], median(times[m]));
  fmt::print("folded / plain {:.1f} %, results differ by {:.1e} of their norm\n",
             100.0 * median(times[1]) / median(times[0]), std::sqrt(difference / norm));
}

}  // namespace

int main(int argc, char** argv) {
  try {
    run(argc > 1 ? std::max(1, std::atoi(argv[1])) : 15);
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_light_propagation_volumes: {}\n", error.what());
    return 2;
  }
  return 0;
}
