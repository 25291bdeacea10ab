// The cost of a frame on the host: draw calls, and the bounds of moving objects.
// usage: bench_gpu [draws] [vertices] [repeats], or bench_gpu --quick
//
// The draws are those of the g-buffer, one per part of the scene. Each part is one triangle that covers at
// most a pixel, so that the host does most of the work.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <string_view>

#include "lumivox/gpu/device.h"
#include "lumivox/pipeline/pipeline.h"
#include "lumivox/plugin/loader.h"

namespace {

using namespace lumivox;
using Clock = std::chrono::steady_clock;

double millisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// A scene of parts with one triangle each, spread along a curve through the unit cube.
Scene partsScene(int parts) {
  Scene scene;
  scene.name = "parts";
  scene.materials.emplace_back();
  Object object;
  object.name = "parts";
  for (int part = 0; part < parts; ++part) {
    const float at = static_cast<float>(part) / static_cast<float>(parts);
    const auto first = static_cast<std::uint32_t>(scene.positions.size());
    for (const glm::vec3 corner : {glm::vec3(0), glm::vec3(0.02f, 0, 0), glm::vec3(0, 0.02f, 0.01f)}) {
      scene.positions.push_back(glm::vec3(at, 1.0f - at, at * at) + corner);
      scene.normals.emplace_back(0, 0, 1);
      scene.texcoords.emplace_back(0, 0);
      scene.indices.push_back(static_cast<std::uint32_t>(scene.indices.size()));
    }
    object.parts.push_back({0, first, 3});
  }
  object.vertexCount = static_cast<std::uint32_t>(scene.positions.size());
  scene.objects.push_back(object);
  Camera camera;
  camera.name = "main";
  camera.width = camera.height = 16;
  scene.cameras.push_back(camera);
  return scene;
}

/// A turning sphere with this many vertices.
Scene movingScene(int vertices) {
  Scene scene = partsScene(1);
  scene.positions.clear();
  // Vertices in tiles of 16 x 16, an order as in models that are optimised for vertex caches. The square of
  // tiles is folded to an octahedron, which is projected onto the sphere.
  const int tiles = std::max(1, static_cast<int>(std::sqrt(vertices / 256.0)));
  for (int i = 0; i < vertices; ++i) {
    const int tile = i / 256 % (tiles * tiles), within = i % 256;
    const double u = (tile % tiles * 16 + within % 16 + 0.5) / (8.0 * tiles) - 1.0;
    const double v = (tile / tiles * 16 + within / 16 + 0.5) / (8.0 * tiles) - 1.0;
    glm::dvec3 point(u, v, 1.0 - std::abs(u) - std::abs(v));
    if (point.z < 0.0) {
      point.x = (1.0 - std::abs(v)) * (u < 0.0 ? -1.0 : 1.0);
      point.y = (1.0 - std::abs(u)) * (v < 0.0 ? -1.0 : 1.0);
    }
    scene.positions.emplace_back(glm::normalize(point));
  }
  scene.normals = scene.positions;
  scene.texcoords.assign(scene.positions.size(), {0, 0});
  Object& object = scene.objects.front();
  object.vertexCount = static_cast<std::uint32_t>(vertices);
  object.motion = RigidMotion{};
  object.motion->angularSpeed = 1.0;
  object.sweptBounds = {glm::dvec3(-1.0), glm::dvec3(1.0)};
  object.placedBounds = object.sweptBounds;
  return scene;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const auto argument = [&](int index, int otherwise) {
      return argc > index ? std::atoi(argv[index]) : otherwise;
    };
    const bool quick = argc > 1 && std::string_view(argv[1]) == "--quick";
    const int draws = quick ? 2000 : std::max(argument(1, 57600), 1);
    const int vertices = quick ? 10000 : std::max(argument(2, 1000000), 1);
    const int repeats = quick ? 1 : std::max(argument(3, 11), 1);
    gpu::Device device;
    TechniqueSet techniques(TechniqueSet::defaultDirectories({}));
    const Scene scene = partsScene(draws);
    const Pipeline pipeline = Pipeline::load("scenes/pipelines/direct_lighting.pipeline");
    RenderOptions options;
    options.wantsOutputs = false;
    PipelineExecutor executor(device, techniques, scene, pipeline, options);
    executor.keepOutput("gbuffer", "gbuffer");
    std::vector<double> hostMs;
    for (int repeat = -1; repeat < repeats; ++repeat) {  // one as warm-up
      executor.invalidate();
      const FrameResult frame = executor.render(0.0, 0, PipelineExecutor::Images::no);
      if (repeat >= 0) hostMs.push_back(frame.passes.front().hostMs);
    }
    fmt::print("{} draws on {}: host {:.1f} ms, {:.2f} us a draw (median of {})\n", draws,
               device.info().renderer, median(hostMs), 1e3 * median(hostMs) / draws, repeats);

    const Scene moving = movingScene(vertices);
    std::vector<double> snapshotMs;
    for (int repeat = 0; repeat < repeats; ++repeat) {
      const auto start = Clock::now();
      const SceneSnapshot snapshot = snapshotOf(moving, 0.1 * (repeat + 1));
      snapshotMs.push_back(millisecondsSince(start));
    }
    fmt::print("bounds of {} moving vertices: {:.2f} ms\n", vertices, median(snapshotMs));
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_gpu: {}\n", error.what());
    return 2;
  }
  return 0;
}
