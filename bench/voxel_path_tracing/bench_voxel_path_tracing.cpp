// Paths through bits on `cornell`: light carried back over stored surfaces, as published, over light added as
// it is met, in time and bytes; the path tracer of the reference over paths through bits, at equal samples
// and at equal error; and paths that end at planes within voxels over those that end at boxes, in time and
// error, on several scenes. Times are taken in turns; printed are medians and quartiles of ratios. usage:
// bench_voxel_path_tracing [--quick | REPEATS] (default: 7), from the project's folder.
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

/// RMS error of light of two bounces, without the reference's noise.
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

/// Paths that end at boxes with twice the offset, as the pipeline has them, and at planes. Errors are over
/// those of no indirect light.
void compareStops(Machine& machine, const std::string& name, int side, const std::vector<int>& samples,
                  int referenceSamples) {
  const Scene scene = loadScene("scenes/" + name + ".scene");
  const LayeredImage truth = renderReference(scene, tracer(side, referenceSamples, 7));
  ImageBuffer none(side, side, 3);
  const double ofNone = errorOf(none, truth);
  for (const int count : samples) {
    const std::string paths = fmt::format("samples={}", count);
    Bench boxes(machine, scene, Pipeline::load(kPipeline), {paths}, side),
        planes(machine, scene, Pipeline::load(kPipeline), {paths, "stop=plane", "offset=0.5"}, side);
    std::vector<double> ratios, ms;
    for (int repeat = -1; repeat < machine.repeats; ++repeat) {
      const double ofBoxes = boxes.afresh().at("trace"), ofPlanes = planes.afresh().at("trace");
      if (repeat < 0) continue;
      ratios.push_back(ofPlanes / ofBoxes);
      ms.push_back(ofBoxes);
    }
    const auto error = [&](Bench& bench) {
      return errorOf(bench.pictured().outputs.at("indirect_diffuse"), truth) / ofNone;
    };
    row(fmt::format("{}, {} paths: time of planes over boxes; errors of both; ms of boxes", name, count),
        fmt::format("{}  {:.3f} {:.3f}  {:.3g}", inWords(ratios), error(boxes), error(planes),
                    spreadOf(ms).median));
  }
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
    for (const char* name : {"cornell", "cornell_glossy", "corridor", "arcade", "spinning_box", "sibenik",
                             "untuned/court", "untuned/room"}) {
      if (quick && name != std::string("cornell")) continue;
      compareStops(machine, name, quick ? 16 : 64,
                   quick ? std::vector{2} : std::vector{4, 8, 16, 32, 64, 256}, quick ? 16 : 1024);
    }
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_voxel_path_tracing: {}\n", error.what());
    return 1;
  }
}
