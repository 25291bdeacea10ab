// Layered reflective shadow maps against cone tracing through a dense grid of radiance, in the Cornell box:
// bytes that cones read, at 256^3 under one sun, and time and bytes under 1 to 16 spots. The ratios show from
// how many spots on cone tracing is cheaper, a weakness that the thesis names (Gomes 2015, Sec. 3.3 and 3.6).
// Times are taken in turns; printed are medians and quartiles of ratios.
// usage: bench_layered_reflective_shadow_maps [--quick | REPEATS] (default: 7), from the project's folder.
// --quick: seconds of work, whose figures mean nothing, for the tests
#include <exception>
#include <glm/glm.hpp>

#include "../timed_pipelines.h"
#include "lumivox/scene/builder.h"

namespace {

using namespace lumivox;

/// The box without its lamp, under a row of spots below its ceiling or, for 0 spots, under a sun.
Scene cornellUnder(int spots) {
  Scene scene = loadScene("scenes/cornell.scene");
  for (Material& material : scene.materials) material.emission = glm::vec3(0.0f);
  scene.lights.clear();
  const auto add = [&](LightKind kind, const glm::dvec3& place, const glm::dvec3& direction, float power) {
    Light light;
    light.name = fmt::format("light {}", scene.lights.size());
    light.kind = kind;
    light.power = glm::vec3(power);
    light.position = place;
    light.direction = glm::normalize(direction);
    light.innerAngle = 0.5, light.outerAngle = 0.7;
    scene.lights.push_back(light);
  };
  if (spots == 0) add(LightKind::directional, {}, {0.3, -0.5, 1.0}, 3.0f);
  for (int i = 0; i < spots; ++i)
    add(LightKind::spot, {0.08 + 0.4 * (i + 0.5) / spots, 0.53, 0.2}, {0.02 * i - 0.1, -1.0, 0.2},
        3.0f / static_cast<float>(spots));
  return scene;
}

std::uint64_t bytesOf(const PipelineExecutor& executor, const char* pass, const char* port) {
  std::uint64_t bytes = 0;
  const PortContents contents = executor.output(pass, port)->contents();
  for (const PortContents::Resource& resource : contents.resources()) {
    // Lights and views come from the shadow maps, which every pipeline has.
    if (resource.what->name == "lights" || resource.what->name == "views") continue;
    if (resource.texture) bytes += resource.texture->sizeBytes();
    if (resource.buffer) bytes += resource.buffer->sizeBytes();
  }
  return bytes;
}

/// Both pipelines on a scene, which must outlive them.
class Pair {
 public:
  Pair(Machine& machine, const Scene& scene, int resolution, int size)
      : layered_(machine, scene, Pipeline::load("scenes/pipelines/layered_reflective_shadow_maps.pipeline"),
                 {fmt::format("resolution={}", resolution)}, size),
        grid_(machine, scene, Pipeline::load("scenes/pipelines/voxel_cone_tracing.pipeline"),
              {fmt::format("resolution={}", resolution)}, size) {
    layered_.keep("layers", "layers");
    layered_.keep("occlusion", "levels");
    grid_.keep("grid", "mips");
  }
  /// ms of the frame's indirect light.
  double ofLayered() {
    return sumOf(layered_.afresh(), {"average", "occlusion", "lights", "layers", "gather", "smooth"});
  }
  double ofGrid() { return sumOf(grid_.afresh(), {"light", "grid", "gather"}); }
  std::uint64_t opacityBytes() { return bytesOf(layered_.executor(), "occlusion", "levels"); }
  std::uint64_t layerBytes() { return bytesOf(layered_.executor(), "layers", "layers"); }
  std::uint64_t gridBytes() { return bytesOf(grid_.executor(), "grid", "mips"); }

 private:
  Bench layered_, grid_;
};

double mebibytes(std::uint64_t bytes) {
  return static_cast<double>(bytes) / (1024.0 * 1024.0);
}

void compareBytes(Machine& machine, int resolution, int size) {
  const Scene scene = cornellUnder(0);
  Pair pair(machine, scene, resolution, size);
  pair.ofLayered();
  pair.ofGrid();
  const double ours = mebibytes(pair.opacityBytes() + pair.layerBytes()), grid = mebibytes(pair.gridBytes());
  row(fmt::format("MiB at {} voxels under a sun: opacities, layers, the grid of cone tracing", resolution),
      fmt::format("{:.1f}, {:.1f}, {:.1f}", mebibytes(pair.opacityBytes()), mebibytes(pair.layerBytes()),
                  grid));
  row("bytes over those of the grid", fmt::format("{:.3f}", ours / grid));
}

void compareLights(Machine& machine, int resolution, int size, const std::vector<int>& numbers) {
  for (const int spots : numbers) {
    const Scene scene = cornellUnder(spots);
    Pair pair(machine, scene, resolution, size);
    std::vector<double> ratios;
    for (int repeat = -1; repeat < machine.repeats; ++repeat) {
      const double layered = pair.ofLayered(), grid = pair.ofGrid();
      if (repeat >= 0) ratios.push_back(layered / grid);
    }
    row(fmt::format("time over that of cone tracing, {} spots, {} voxels", spots, resolution),
        inWords(ratios));
    row(fmt::format("MiB of layers, {} spots; over the grid, with opacities", spots),
        fmt::format("{:.2f}; {:.3f}", mebibytes(pair.layerBytes()),
                    static_cast<double>(pair.layerBytes() + pair.opacityBytes()) /
                        static_cast<double>(pair.gridBytes())));
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const bool quick = argc > 1 && std::string_view(argv[1]) == "--quick";
    Machine machine;
    machine.repeats = quick ? 1 : argc > 1 ? repeatsOf(argv[1], "bench_layered_reflective_shadow_maps") : 7;
    compareBytes(machine, quick ? 16 : 256, 16);
    compareLights(machine, quick ? 16 : 64, quick ? 16 : 96,
                  quick ? std::vector{2} : std::vector{1, 2, 4, 8, 16});
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_layered_reflective_shadow_maps: {}\n", error.what());
    return 1;
  }
}
