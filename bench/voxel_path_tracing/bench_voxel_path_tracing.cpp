// Paths through bits on `cornell`: light carried back over stored surfaces, as published, over light added as
// it is met, in time and bytes; and the path tracer of the reference over paths through bits, at equal
// samples and at equal error. Times are taken in turns; printed are medians and quartiles of ratios.
// usage: bench_voxel_path_tracing [--quick | REPEATS] (default: 7), from the project's folder.
// --quick: seconds of work, whose figures mean nothing, for the tests
#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>

#include "../timed_pipelines.h"
#include "lumivox/base/file.h"
#include "lumivox/measure/metrics.h"
#include "lumivox/reference/path_tracer.h"
#include "lumivox/scene/builder.h"

namespace {

using namespace lumivox;

const char* const kPipeline = "scenes/pipelines/voxel_path_tracing.pipeline";

Pipeline ofOrder(const std::string& order) {
  std::string text = readFile(kPipeline);
  const std::string before = "voxel_path_tracing.trace {\n";
  text.insert(text.find(before) + before.size(), "    order " + order + "\n");
  return Pipeline::parse(text, kPipeline);
}

/// RMS error of indirect diffuse light, without the reference's noise.
double errorOf(const ImageBuffer& image, const LayeredImage& truth) {
  const ImageError error =
      compare(image, truth.layers.at("bounces_2_diffuse"), truth.layers.at("bounces_2_diffuse.variance"));
  return std::sqrt(std::max(0.0, error.rmse.value * error.rmse.value - error.noiseFloor * error.noiseFloor));
}

ReferenceOptions tracer(int side, int samples, std::uint64_t seed) {
  ReferenceOptions options;
  options.samplesPerPixel = samples;
  options.bounces = 2;
  options.bounceLayers = {2};
  options.width = options.height = side;
  options.seed = seed;
  options.progress = options.useCache = false;
  return options;
}

void compareOrders(Machine& machine, const Scene& scene, int side, const std::vector<int>& bounces) {
  for (const int count : bounces) {
    const std::vector<std::string> settings{"samples=4", fmt::format("bounces={}", count)};
    Bench forward(machine, scene, ofOrder("forward"), settings, side),
        backward(machine, scene, ofOrder("backward"), settings, side);
    std::vector<double> ratios;
    for (int repeat = -1; repeat < machine.repeats; ++repeat) {
      const double ofForward = forward.afresh().at("trace"), ofBackward = backward.afresh().at("trace");
      if (repeat >= 0) ratios.push_back(ofBackward / ofForward);
    }
    row(fmt::format("order backward over forward, time, {} bounces", count), inWords(ratios));
    // Textures of four floats per pixel: three forward; backward, four per bounce and two more.
    row(fmt::format("order backward over forward, bytes of paths, {} bounces", count),
        fmt::format("{:.3g}", (4.0 * count + 2.0) / 3.0));
  }
}

void comparePathTracer(Machine& machine, const Scene& scene, int side, int samples, int referenceSamples) {
  const LayeredImage truth = renderReference(scene, tracer(side, referenceSamples, 7));
  const auto seconds = [](auto&& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  Bench paths(machine, scene, Pipeline::load(kPipeline),
              {fmt::format("samples={}", samples), "resolution=128"}, side);
  paths.afresh();
  std::vector<double> equalSamples, equalError;
  for (int repeat = 0; repeat < machine.repeats; ++repeat) {
    paths.executor().invalidate();
    FrameResult frame;
    const double ofPaths = seconds([&] { frame = paths.pictured(); });
    LayeredImage traced;
    const double ofTracer = seconds([&] {
      traced = renderReference(scene, tracer(side, samples, 100 + static_cast<std::uint64_t>(repeat)));
    });
    const double error = errorOf(frame.outputs.at("indirect_diffuse"), truth),
                 tracersError = errorOf(traced.layers.at("bounces_2_diffuse"), truth);
    equalSamples.push_back(ofTracer / ofPaths);
    // The tracer's error is noise alone, which falls with the square root of its time.
    equalError.push_back(ofTracer * std::pow(tracersError / error, 2.0) / ofPaths);
  }
  row(fmt::format("path tracer over paths, time, {} samples each", samples), inWords(equalSamples));
  row("path tracer over paths, time at equal error", inWords(equalError));
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const bool quick = argc > 1 && std::string_view(argv[1]) == "--quick";
    Machine machine;
    machine.repeats = quick ? 1 : argc > 1 ? repeatsOf(argv[1], "bench_voxel_path_tracing") : 7;
    const Scene scene = loadScene("scenes/cornell.scene");
    const int side = quick ? 16 : 128;
    compareOrders(machine, scene, side, quick ? std::vector{2} : std::vector{1, 2, 8, 64});
    comparePathTracer(machine, scene, side, quick ? 2 : 64, quick ? 16 : 1024);
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_voxel_path_tracing: {}\n", error.what());
    return 1;
  }
}
