// Rays through bits by each method on `cornell`: texel reads and time. Also gathering at a quarter of the
// resolution along each side against all pixels, accumulated frames against single ones, and bits that are
// updated for moving triangles against bits made anew. Times are taken in turns within each frame; printed
// are medians and quartiles of ratios.
// usage: bench_near_field_voxels [--quick | SIZE [REPEATS]] (default: 128 7), from the project's folder.
// --quick: seconds of work, whose figures mean nothing, for the tests
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "../spread.h"
#include "lumivox/base/error.h"
#include "lumivox/measure/metrics.h"
#include "lumivox/pipeline/pipeline.h"
#include "lumivox/plugin/loader.h"
#include "lumivox/scene/builder.h"

namespace {

using namespace lumivox;

std::string inWords(const Spread& spread) {
  return fmt::format("{:.2f} [{:.2f}, {:.2f}]", spread.median, spread.lower, spread.upper);
}

using Times = std::map<std::string, double>;  ///< ms by pass
using Ratios = std::map<std::string, std::vector<double>>;

/// Renders `repeats` frames after two of warm-up; `each` gets the times of every one.
template <class Each>
FrameResult measure(PipelineExecutor& executor, int repeats, bool anew, Each&& each) {
  FrameResult last;
  for (int repeat = -2; repeat < repeats; ++repeat) {
    if (anew) executor.invalidate();
    last = executor.render(
        0.0, 0, repeat == repeats - 1 ? PipelineExecutor::Images::yes : PipelineExecutor::Images::no,
        PipelineExecutor::Timing::passes);
    for (const std::vector<PassRecord>& frame : executor.timedPasses()) {
      Times times;
      for (const PassRecord& pass : frame) times[pass.name] = pass.deviceMs;
      if (repeat >= 0) each(times);
    }
  }
  return last;
}

constexpr const char* kBegin = R"(
pipeline "bench" {
  param resolution 64 in 1..1024
  pass gbuffer direct_lighting.gbuffer { }
  pass voxels voxelization.conservative { resolution $resolution }
  pass bits voxelization.average { fragments voxels.fragments }
)";

Pipeline ofMethods(const std::vector<std::string>& methods, const char* output) {
  std::string text = kBegin, outputs;
  for (const std::string& method : methods) {
    text += fmt::format(
        "  pass {0} near_field_voxels.gather {{ gbuffer gbuffer  bits bits.bits  rays 16  occlusion_distance 1e6 m  method {0} }}\n",
        method);
    outputs += fmt::format("  output {0} {0}.{1}\n", method, output);
  }
  return Pipeline::parse(text + outputs + "}\n", "bench.pipeline");
}

void compareMethods(gpu::Device& device, TechniqueSet& techniques, const Scene& scene, int size, int repeats,
                    const std::vector<int>& resolutions) {
  fmt::print("{:>11}{:>24}{:>12}{:>24}{:>24}{:>24}\n", "voxels", "texels, of plain", "stacks",
             "time, of plain", "stacks", "printed");
  for (const int resolution : resolutions) {
    std::vector<std::string> methods{"hierarchy", "stacks", "plain"};
    if (resolution <= 128) methods.emplace_back("printed");  // one texel along z
    RenderOptions options;
    options.width = options.height = size;
    const Pipeline counting = ofMethods({"hierarchy", "stacks", "plain"}, "fetches"),
                   timed = ofMethods(methods, "occlusion");
    options.parameters = counting.settings({fmt::format("resolution={}", resolution)});
    PipelineExecutor counter(device, techniques, scene, counting, options);
    const FrameResult counted = counter.render(0.0);
    std::map<std::string, double> read;
    for (const auto& [name, image] : counted.outputs)
      for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) read[name] += image.at(x, y, 0);
    PipelineExecutor executor(device, techniques, scene, timed, options);
    Ratios ratios;
    measure(executor, repeats, true, [&](const Times& times) {
      for (const std::string& method : methods)
        ratios[method].push_back(times.at(method) / times.at("plain"));
    });
    fmt::print("{:>11}{:>24.3f}{:>12.3f}{:>24}{:>24}{:>24}\n", resolution,
               read.at("hierarchy") / read.at("plain"), read.at("stacks") / read.at("plain"),
               inWords(spreadOf(ratios.at("hierarchy"))), inWords(spreadOf(ratios.at("stacks"))),
               ratios.contains("printed") ? inWords(spreadOf(ratios.at("printed"))) : "-");
  }
}

/// Gathers at all pixels and at one of each 4 x 4, with 16 rays, both smoothed over 16 pixels. Without
/// smoothing, the noise at all pixels alone gives a FLIP of 0.065 from 256 rays.
void comparePixels(gpu::Device& device, TechniqueSet& techniques, const Scene& scene, const char* name,
                   int size, int repeats, int resolution) {
  std::string text = kBegin;
  text +=
      "  pass shadow direct_lighting.shadow_map { }\n"
      "  pass direct direct_lighting.shade { gbuffer gbuffer  shadow shadow.depth }\n"
      "  pass lights reflective_shadow_maps.render { }\n";
  for (const char* pixels : {"full", "quarter"})
    text += fmt::format(
        "  pass {0} near_field_voxels.gather {{ gbuffer gbuffer  bits bits.bits  map lights.map  rays 16  offset 1.5  pixels {0} }}\n"
        "  pass {0}_smooth image_filters.smooth {{ gbuffer gbuffer  diffuse {0}.arriving  kernel gaussian  radius 16 }}\n"
        "  pass {0}_image direct_lighting.compose {{ direct direct.radiance  diffuse {0}_smooth.diffuse }}\n"
        "  output {0} {0}_image.radiance\n",
        pixels);
  const Pipeline pipeline = Pipeline::parse(text + "}\n", "bench.pipeline");
  RenderOptions options;
  options.width = options.height = size;
  options.parameters = pipeline.settings({fmt::format("resolution={}", resolution)});
  PipelineExecutor executor(device, techniques, scene, pipeline, options);
  std::vector<double> ratios;
  const FrameResult last = measure(executor, repeats, true, [&](const Times& times) {
    ratios.push_back((times.at("quarter") + times.at("quarter_smooth")) / times.at("full"));
  });
  const ImageError error = compare(last.outputs.at("quarter"), last.outputs.at("full"));
  fmt::print(
      "{}: quarter with smoothing over full without {}, FLIP between the smoothed images {:.4f}, before display {:.4f}\n",
      name, inWords(spreadOf(ratios)), error.flipLdr, error.flip);
}

/// The time of gather in accumulated frames over that in single ones.
void compareFrames(gpu::Device& device, TechniqueSet& techniques, const Scene& scene, int size, int repeats,
                   int resolution) {
  const Pipeline pipeline = Pipeline::load("scenes/pipelines/near_field_voxels.pipeline");
  RenderOptions options;
  options.width = options.height = size;
  options.parameters = pipeline.settings({"rays=16", fmt::format("resolution={}", resolution)});
  PipelineExecutor single(device, techniques, scene, pipeline, options);
  options.accumulate = true;
  PipelineExecutor accumulating(device, techniques, scene, pipeline, options);
  std::vector<double> ratios;
  for (int repeat = 0; repeat < repeats; ++repeat) {
    std::vector<double> before, after;
    measure(single, 1, true, [&](const Times& times) { before.push_back(times.at("gather")); });
    measure(accumulating, 1, false, [&](const Times& times) { after.push_back(times.at("gather")); });
    ratios.push_back(after.front() / before.front());
  }
  fmt::print("a frame that accumulates over a single one: {}\n", inWords(spreadOf(ratios)));
}

/// A lattice of 10 x 10 x 10 blocks, of which the first fifth turns, or all.
Scene blocksThatTurn(bool all) {
  SceneBuilder builder;
  const int grey = builder.lambert(0.5f);
  constexpr int kSide = 10, kBlocks = kSide * kSide * kSide;
  for (int i = 0; i < kBlocks; ++i) {
    const glm::vec3 low(i / (kSide * kSide), i / kSide % kSide, i % kSide);
    const std::size_t first = builder.scene.objects.size();
    builder.box(low + 0.2f, low + 0.8f, grey, false);
    if (all || i < kBlocks / 5)
      for (std::size_t o = first; o < builder.scene.objects.size(); ++o)
        builder.scene.objects[o].motion = RigidMotion{{0, 1, 0.2}, 0.7, glm::dvec3(low) + 0.5, {0, 0, 0}};
  }
  builder.look({5, 5, 25}, {5, 5, 5}, {0, 1, 0}, 0.6, 16, 16);
  return builder.scene;
}

/// The time of the bits and their hierarchy in a frame in which a fifth of the triangles move, over that for
/// the same blocks if all move.
void compareMotion(gpu::Device& device, TechniqueSet& techniques, int repeats, int resolution) {
  const Scene part = blocksThatTurn(false), all = blocksThatTurn(true);
  std::string text = kBegin;
  text +=
      "  pass gather near_field_voxels.gather { gbuffer gbuffer  bits bits.bits  rays 1 }\n  output open gather.occlusion\n}\n";
  const Pipeline pipeline = Pipeline::parse(text, "bench.pipeline");
  RenderOptions options;
  options.parameters = pipeline.settings({fmt::format("resolution={}", resolution)});
  PipelineExecutor followed(device, techniques, part, pipeline, options),
      anew(device, techniques, all, pipeline, options);
  const auto bitsMs = [&](PipelineExecutor& executor, int frame) {
    executor.render(0.04 * frame, frame, PipelineExecutor::Images::no, PipelineExecutor::Timing::passes);
    double ms = 0.0;
    for (const std::vector<PassRecord>& one : executor.timedPasses())
      for (const PassRecord& pass : one)
        if (pass.name == "bits") ms = pass.deviceMs;
    return ms;
  };
  std::vector<double> ratios;
  for (int frame = 0; frame < repeats + 2; ++frame) {
    const double incremental = bitsMs(followed, frame), full = bitsMs(anew, frame);
    if (frame >= 2) ratios.push_back(incremental / full);
  }
  fmt::print(
      "bits and hierarchy of a frame in which a fifth of the triangles move, over all of them anew, {} voxels: {}\n",
      resolution, inWords(spreadOf(ratios)));
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const bool quick = argc > 1 && std::string_view(argv[1]) == "--quick";
    const int size = quick ? 16 : argc > 1 ? std::atoi(argv[1]) : 128;
    const int repeats = quick ? 1 : argc > 2 ? std::atoi(argv[2]) : 7;
    if (size < 1 || repeats < 1)
      throw Error(
          "SIZE and REPEATS are numbers from 1; usage: bench_near_field_voxels [--quick | SIZE [REPEATS]]");
    gpu::Device device;
    TechniqueSet techniques(TechniqueSet::defaultDirectories({}));
    const Scene cornell = loadScene("scenes/cornell.scene"), arcade = loadScene("scenes/arcade.scene");
    fmt::print("{0} x {0} pixels, 16 rays, {1} repeats in turns, median [quartiles], on {2}\n", size, repeats,
               device.info().renderer);
    compareMethods(device, techniques, cornell, size, repeats,
                   quick ? std::vector<int>{16} : std::vector<int>{32, 64, 128, 256, 512});
    const int side = quick ? 16 : 4 * size, voxels = quick ? 16 : 64;
    fmt::print("{0} x {0} pixels, {1} voxels:\n", side, voxels);
    comparePixels(device, techniques, cornell, "cornell", side, repeats, voxels);
    comparePixels(device, techniques, arcade, "arcade", side, repeats, voxels);
    compareMotion(device, techniques, 3 * repeats, quick ? 16 : 128);
    compareFrames(device, techniques, cornell, size, repeats, voxels);
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_near_field_voxels: {}\n", error.what());
    return 2;
  }
  return 0;
}
