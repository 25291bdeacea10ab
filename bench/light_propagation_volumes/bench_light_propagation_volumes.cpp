// Propagation in two grids of 32^3 cells over eight iterations: the folded shader against one with the
// structure of Listing 4.32 of thesis 004, in turns, with the difference of their results. Also both
// injections into a grid around a closed room, with the memory of each. Prints medians.
// usage: bench_light_propagation_volumes [--quick] [--repeats N] (default: 15 repeats; quick: 1). Exit code
// 1: the results differ by more than rounding; 2: it could not run.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <exception>
#include <numbers>
#include <random>
#include <string_view>
#include <vector>

#include "../../techniques/light_propagation_volumes/occluded_faces.h"
#include "lumivox/base/error.h"
#include "lumivox/pipeline/pass.h"
#include "lumivox/pipeline/pipeline.h"
#include "lumivox/plugin/loader.h"
#include "lumivox/scene/builder.h"

namespace {

using namespace lumivox;
using light_propagation_volumes::OccludedFaces;

constexpr int kCells = 32, kIterations = 8;
constexpr int kRepeats = 15, kQuickRepeats = 1;
constexpr float kAlbedo = 0.7f;     // of the room
constexpr double kRounding = 1e-5;  // relative to the norm, as in the test of the two shaders

/// Grids in which all cells of the three planes of a corner are lit and all others empty.
std::pair<ShGrid, OccludedFaces> cornerOfLight(gpu::Device& device) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> flux(0.5f, 1.0f);
  ShGrid result;
  OccludedFaces faces;
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
    const OccludedFaces::Level open{
        level.grid, std::make_shared<gpu::Texture>(device, description, "occluded faces"),
        std::make_shared<gpu::Texture>(device, description, "moved surfaces"), nullptr};
    open.occluded->clear(glm::vec4(0.0f));
    open.moved->clear(glm::vec4(0.0f));
    result.levels.push_back(level);
    faces.levels.push_back(open);
  }
  return {result, faces};
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// Measures both injections into a grid of `resolution` cells a side. Returns whether each gives the flux
/// that the walls reflect, albedo 4 pi I.
bool injections(gpu::Device& device, TechniqueSet& techniques, int resolution, int repeats) {
  SceneBuilder builder;
  builder.box({-1, -1, -1}, {1, 1, 1}, builder.lambert(kAlbedo), true);
  builder.light(LightKind::point, glm::vec3(1.0f), {0.3, 0.6, 0.2});
  const SceneSnapshot snapshot = snapshotOf(builder.scene, 0.0);
  const auto pass = [&](const char* technique, const char* name) {
    return std::make_unique<PassHarness>(device, techniques, technique, name, builder.scene, snapshot);
  };
  const auto voxels = pass("voxelization", "conservative");
  voxels->setParameter("resolution", 2 * resolution);
  voxels->run();
  const auto map = pass("reflective_shadow_maps", "render");
  map->run();
  const auto shadow = pass("direct_lighting", "shadow_map");
  shadow->run();
  bool complete = true;
  for (const char* name : {"inject_rsm", "inject_voxels"}) {
    const auto inject = pass("light_propagation_volumes", name);
    inject->setParameter("levels", 1);
    inject->setParameter("resolution", resolution);
    inject->setInput("fragments", voxels->output<VoxelFragments>("fragments"));
    if (std::string_view(name) == "inject_rsm")
      inject->setInput("map", map->output<ReflectiveShadowMap>("map"));
    else
      inject->setInput("shadow", shadow->output<ShadowMap>("depth"));
    const std::uint64_t before = device.allocatedBytes();
    device.resetPeak();
    inject->run();  // compiles
    const std::uint64_t bytes = device.peakBytes() - before;
    std::vector<double> times;
    for (int i = 0; i < repeats; ++i) times.push_back(device.time([&] { inject->run(); }).deviceMs);
    fmt::print("{:<14} {:>3}^3 cells {:9.2f} ms {:8.1f} MiB\n", name, resolution, median(times),
               static_cast<double>(bytes) / (1024.0 * 1024.0));
    const std::vector<float> cells =
        inject->output<ShGrid>("light").levels[0].coefficients[0]->downloadFloats(0);
    double flux = 0.0;  // the integral of the intensity over the sphere: c0 / Y00
    for (std::size_t i = 0; i < cells.size(); i += 4) flux += cells[i] * 2.0 * std::sqrt(std::numbers::pi);
    const double expected = kAlbedo * 4.0 * std::numbers::pi;
    if (std::abs(flux - expected) < 0.1 * expected) continue;
    fmt::print(stderr, "{} gives {:.3g} W; expected {:.3g} W\n", name, flux, expected);
    complete = false;
  }
  return complete;
}

/// Measures both shaders. Returns whether they give the same light.
bool propagation(gpu::Device& device, TechniqueSet& techniques, int repeats) {
  Scene scene;
  scene.cameras.emplace_back();
  const SceneSnapshot snapshot = snapshotOf(scene, 0.0);
  const auto [light, faces] = cornerOfLight(device);
  const char* const methods[] = {"plain", "folded"};
  std::vector<std::unique_ptr<PassHarness>> passes;
  for (const char* method : methods) {
    passes.push_back(std::make_unique<PassHarness>(device, techniques, "light_propagation_volumes",
                                                   "propagate", scene, snapshot));
    passes.back()->setParameter("method", std::string(method));
    passes.back()->setParameter("iterations", kIterations);
    passes.back()->setInput("light", light);
    passes.back()->setInput("faces", faces);
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
  return norm > 0.0 && std::sqrt(difference / norm) < kRounding;
}

struct Options {
  int repeats = kRepeats;
  std::vector<int> cells{32, 96};
};

Options optionsOf(int argc, char** argv) {
  Options options;
  int& repeats = options.repeats;
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (word == "--quick") {
      options = {kQuickRepeats, {32}};
    } else if (word == "--repeats" && i + 1 < argc) {
      const std::string_view number = argv[++i];
      const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), repeats);
      if (error != std::errc() || end != number.data() + number.size() || repeats < 1)
        throw Error(fmt::format("--repeats {}: expected a whole number from 1 on", number));
    } else {
      throw Error(fmt::format("unknown argument '{}'; expected --quick or --repeats N", word));
    }
  }
  return options;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const Options options = optionsOf(argc, argv);
    gpu::Device device;
    TechniqueSet techniques(TechniqueSet::defaultDirectories({LUMIVOX_TECHNIQUES}));
    bool good = propagation(device, techniques, options.repeats);
    for (const int cells : options.cells)
      good = injections(device, techniques, cells, options.repeats) && good;
    if (good) return 0;
    fmt::print(stderr, "bench_light_propagation_volumes: something is broken\n");
    return 1;
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_light_propagation_volumes: {}\n", error.what());
    return 2;
  }
}
