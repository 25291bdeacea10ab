// Rays per second of the path tracer, and of a bare Embree loop over the same rays on the same threads.
// usage: bench_reference [--quick] [scene texts] (default: scenes/cornell.scene and scenes/arcade.scene below
// the current directory). --quick: a second's work, whose figures mean nothing, for the tests.
#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <filesystem>
#include <string_view>
#include <vector>

#include "lumivox/reference/path_tracer.h"
#include "lumivox/scene/scene.h"

int main(int argc, char** argv) {
  try {
    const bool quick = argc > 1 && std::string_view(argv[1]) == "--quick";
    std::vector<std::filesystem::path> files(argv + (quick ? 2 : 1), argv + argc);
    if (files.empty()) files = {"scenes/cornell.scene", "scenes/arcade.scene"};
    fmt::print("{:<28} {:>9} {:>7} {:>11} {:>14} {:>14} {:>7}\n", "scene", "triangles", "threads", "rays",
               "tracer rays/s", "bare rays/s", "ratio");
    for (const std::filesystem::path& file : files) {
      const lumivox::Scene scene = lumivox::loadScene(file);
      for (const int threads : {1, 0}) {
        lumivox::ReferenceOptions options;
        // Small images, since the bare loop needs every ray in memory; many samples per pixel, as in
        // references.
        options.width = options.height = quick ? 16 : 64;
        options.samplesPerPixel = quick ? 4 : 64;
        options.threads = threads;
        options.progress = false;
        const lumivox::TraversalSpeed speed = lumivox::measureTraversalSpeed(scene, options);
        fmt::print("{:<28} {:>9} {:>7} {:>11} {:>14.3g} {:>14.3g} {:>6.1f}%\n", file.filename().string(),
                   scene.triangleCount(), threads == 0 ? "all" : "1", speed.rays, speed.tracerRaysPerSecond,
                   speed.bareRaysPerSecond, 100.0 * speed.tracerRaysPerSecond / speed.bareRaysPerSecond);
        std::fflush(stdout);
      }
    }
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_reference: {}\n", error.what());
    return 2;
  }
  return 0;
}
