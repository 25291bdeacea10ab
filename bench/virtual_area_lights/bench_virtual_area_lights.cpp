// Times of virtual area lights: sparse points against every light at every pixel, and against reflective
// shadow maps of equal error; growth with points, lights and pixels; lights in one patch over lights
// everywhere; the methods by which lights reach the points; points made once, and points that all move.
// Printed are medians and quartiles of ratios of times that were taken in turns.
// usage: bench_virtual_area_lights [--quick | REPEATS] (default: 5), from the project's folder. --quick:
// seconds of work, whose figures mean nothing, for the tests
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <string>
#include <string_view>
#include <vector>

#include "../../techniques/virtual_area_lights/points/surface_points.h"
#include "../timed_pipelines.h"
#include "lumivox/measure/metrics.h"
#include "lumivox/reference/path_tracer.h"

namespace {

using namespace lumivox;
using namespace lumivox::virtual_area_lights;

// Sparse points and every light at every pixel, from the same lights.
constexpr const char* kBoth = R"(
pipeline "sparse points and brute force" {
  param lights 4096 in 1..1048576
  param points 2048 in 1..262144
  param occlusion on in [on off]
  param method shared in [cached shared]
  pass gbuffer direct_lighting.gbuffer { }
  pass shadow direct_lighting.shadow_map { }
  pass direct direct_lighting.shade { gbuffer gbuffer  shadow shadow.depth }
  pass points virtual_area_lights.points { points $points }
  pass map reflective_shadow_maps.render { }
  pass choose reflective_shadow_maps.choose { map map.map  lights $lights }
  pass gather virtual_area_lights.gather { points points.points  lights choose.lights  method $method }
  pass normalise virtual_area_lights.normalise { points points.points  light gather.light }
  pass occlude virtual_area_lights.occlude { points points.points  light normalise.light  occlusion $occlusion }
  pass apply virtual_area_lights.apply { gbuffer gbuffer  points points.points  light occlude.light }
  pass sum virtual_area_lights.brute_force { gbuffer gbuffer  lights choose.lights }
  output direct direct.radiance
  output indirect_diffuse apply.diffuse
  output indirect_glossy apply.glossy
  output all_diffuse sum.diffuse
  output all_glossy sum.glossy
}
)";

const std::vector<std::string> kSparse{"gather", "normalise", "occlude", "apply"};

std::vector<std::string> settingsOf(int lights, int points, const std::string& more = "occlusion=on") {
  return {fmt::format("lights={}", lights), fmt::format("points={}", points), more};
}

double rms(const ImageBuffer& image, const ImageBuffer* other = nullptr) {
  double squared = 0.0;
  for (std::size_t i = 0; i < image.values().size(); ++i)
    squared += std::pow(double{image.values()[i]} - (other != nullptr ? double{other->values()[i]} : 0.0), 2);
  return std::sqrt(squared / static_cast<double>(image.values().size()));
}

/// The time of every light at every pixel over that of sparse points, for both lobes, and the error of the
/// diffuse one.
void overBruteForce(Machine& machine, const Scene& scene, int lights, int points, int size) {
  const Pipeline pipeline = Pipeline::parse(kBoth, "bench.pipeline");
  Bench unoccluded(machine, scene, pipeline, settingsOf(lights, points, "occlusion=off"), size);
  const FrameResult frame = unoccluded.pictured();
  const ImageBuffer& all = frame.outputs.at("all_diffuse");
  Bench bench(machine, scene, pipeline, settingsOf(lights, points), size);
  const std::vector<Times> times = bench.severalAfresh();
  row(fmt::format("{} lights at each of {} x {} pixels over {} points with apply", lights, size, size,
                  points),
      inWords(ratios(times, {"sum"}, kSparse)));
  for (const std::string& pass : kSparse)
    row(fmt::format("  share of {}", pass), inWords(ratios(times, {pass}, kSparse)));
  row("  RMS difference of the diffuse lobe without occlusion, over that of none",
      fmt::format("{:.3f}", rms(frame.outputs.at("indirect_diffuse"), &all) / rms(all)));
}

struct Setting {
  int lights, points;
  const char* occlusion;
};

/// The time of sparse points over that of reflective shadow maps at several settings, with the errors of
/// both. The g-buffer and direct light, which both have, do not count.
void overReflectiveShadowMaps(Machine& machine, const Scene& scene, int size, int samples,
                              const std::vector<Setting>& settings) {
  ReferenceOptions options;
  options.samplesPerPixel = samples;
  options.width = options.height = size;
  options.progress = false;
  const LayeredImage reference = cachedReference(scene, options);
  const ImageBuffer &right = reference.layers.at("one_bounce_diffuse"),
                    &variance = reference.layers.at("one_bounce_diffuse.variance");
  const auto errorOf = [&](const FrameResult& frame) {
    const ImageError error = compare(frame.outputs.at("indirect_diffuse"), right, variance);
    return std::sqrt(
               std::max(0.0, error.rmse.value * error.rmse.value - error.noiseFloor * error.noiseFloor)) /
           rms(right);
  };
  const Pipeline maps = Pipeline::load("scenes/pipelines/reflective_shadow_maps.pipeline"),
                 sparse = Pipeline::load("scenes/pipelines/virtual_area_lights.pipeline");
  Bench other(machine, scene, maps, {"samples=400"}, size);
  const double wanted = errorOf(other.pictured());
  fmt::print(
      "cornell, {} x {} pixels: reflective shadow maps of 400 texels have an error of {:.3f}; of their time\n",
      size, size, wanted);
  for (const Setting& setting : settings) {
    Bench bench(machine, scene, sparse,
                settingsOf(setting.lights, setting.points, fmt::format("occlusion={}", setting.occlusion)),
                size);
    const double error = errorOf(bench.pictured());
    std::vector<double> lightTimes, frames;
    bench.afresh(), other.afresh();
    for (int i = 0; i < machine.repeats; ++i) {
      // Points are spread once, so the second frame measures a light that changes.
      const Times here = bench.afresh(), there = other.afresh();
      lightTimes.push_back(sumOf(here, {"map", "choose", "gather", "normalise", "occlude", "apply"}) /
                           sumOf(there, {"lights", "choose", "gather"}));
      frames.push_back((total(here) - here.at("points")) / total(there));
    }
    row(fmt::format("  {} lights, {} points, occlusion {}: error {:.3f}{}", setting.lights, setting.points,
                    setting.occlusion, error, error <= wanted ? "" : " (larger)"),
        inWords(lightTimes) + ", of the whole frame " + inWords(frames));
  }
}

std::vector<double> msOf(const std::vector<Times>& frames, const std::string& pass) {
  std::vector<double> result;
  for (const Times& frame : frames) result.push_back(frame.at(pass));
  return result;
}

/// Exponents of the passes' times in the number of lights, or of points.
void growth(Machine& machine, const Scene& scene, const std::vector<int>& numbers, bool ofLights, int other) {
  fmt::print("growth with {}, {} {}\n", ofLights ? "lights" : "points", other,
             ofLights ? "points" : "lights");
  const Pipeline pipeline = Pipeline::parse(kBoth, "bench.pipeline");
  Growth growth;
  for (const int number : numbers) {
    Bench bench(machine, scene, pipeline, settingsOf(ofLights ? number : other, ofLights ? other : number));
    const std::vector<Times> frames = bench.severalAfresh();
    for (const char* pass : {"gather", "occlude", "apply", "points"})
      growth.add(fmt::format("{}, ms", pass), number, spreadOf(msOf(frames, pass)).median);
  }
  growth.print();
}

/// One frame with far more points than useful.
void manyPoints(Machine& machine, const Scene& scene, int lights, int points) {
  Bench bench(machine, scene, Pipeline::parse(kBoth, "bench.pipeline"),
              settingsOf(lights, points, "occlusion=off"));
  const Times frame = bench.afresh();
  row(fmt::format("{} points, {} lights, no occlusion: spread, gathered, applied, ms", points, lights),
      fmt::format("{:.0f}, {:.0f}, {:.0f}", frame.at("points"), frame.at("gather"), frame.at("apply")));
}

/// Times of the passes at four times the pixels over those at `size` x `size`.
void growthWithPixels(Machine& machine, const Scene& scene, int size) {
  const Pipeline pipeline = Pipeline::load("scenes/pipelines/virtual_area_lights.pipeline");
  Bench small(machine, scene, pipeline, {}, size), large(machine, scene, pipeline, {}, 2 * size);
  small.afresh(), large.afresh();
  std::map<std::string, std::vector<double>> ratio;
  for (int i = 0; i < machine.repeats; ++i) {
    const Times before = small.afresh(), after = large.afresh();
    for (const auto& [pass, ms] : before) ratio[pass].push_back(after.at(pass) / ms);
  }
  fmt::print("{} x {} pixels over {} x {}\n", 2 * size, 2 * size, size, size);
  for (const auto& [pass, values] : ratio) row("  " + pass, inWords(values));
}

/// The time with a lamp that lights one patch over that with a lamp that lights everything.
void patch(Machine& machine, Scene scene, int lights, int points) {
  const Pipeline pipeline = Pipeline::parse(kBoth, "bench.pipeline");
  for (Material& material : scene.materials) material.emission = glm::vec3(0.0f);
  Light lamp;
  lamp.name = "lamp";
  lamp.kind = LightKind::point;
  lamp.power = glm::vec3(1.0f);
  lamp.position = {0.278, 0.3, 0.1};
  scene.lights = {lamp};
  scene.hash = {};
  Scene narrow = scene;
  Light& spot = narrow.lights.front();
  spot.kind = LightKind::spot;
  spot.direction = {0, -1, 0};
  spot.innerAngle = spot.outerAngle = 0.2f;
  Bench everywhere(machine, scene, pipeline, settingsOf(lights, points)),
      inOnePatch(machine, narrow, pipeline, settingsOf(lights, points));
  everywhere.afresh(), inOnePatch.afresh();
  std::vector<double> sparse, gathered;
  for (int i = 0; i < machine.repeats; ++i) {
    const Times all = everywhere.afresh(), one = inOnePatch.afresh();
    sparse.push_back(sumOf(one, kSparse) / sumOf(all, kSparse));
    gathered.push_back(one.at("gather") / all.at("gather"));
  }
  row(fmt::format("{} lights in one patch over all over, {} points", lights, points), inWords(sparse));
  row("  gather alone", inWords(gathered));
}

/// The time of gather by method `cached` over that by method `shared` (memory of a work group).
void methods(Machine& machine, const Scene& scene, int lights, int points) {
  const Pipeline pipeline = Pipeline::parse(kBoth, "bench.pipeline");
  Bench cached(machine, scene, pipeline, settingsOf(lights, points, "method=cached")),
      shared(machine, scene, pipeline, settingsOf(lights, points, "method=shared"));
  cached.afresh(), shared.afresh();
  std::vector<double> ratio;
  for (int i = 0; i < machine.repeats; ++i)
    ratio.push_back(cached.afresh().at("gather") / shared.afresh().at("gather"));
  row(fmt::format("{} lights at {} points: cached over shared, gather", lights, points), inWords(ratio));
}

/// The time to make the points and their neighbours, once per scene.
void pointsOnce(Machine& machine, const std::string& name, int points) {
  const Scene scene = loadScene("scenes/" + name + ".scene");
  std::vector<double> seconds;
  for (int i = 0; i < machine.repeats; ++i) {
    const auto start = std::chrono::steady_clock::now();
    const SurfacePointSet set = spreadSurfacePoints(scene, {.points = points});
    const SurfacePointGrid grid = gridOf(set, stateOf(set, scene, snapshotOf(scene, 0.0)));
    seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    if (grid.points.empty()) throw Error("no points on " + name);
  }
  row(fmt::format("{}: {} points and their neighbours, s", name, points), inWords(seconds));
}

/// The time of pass `points`, on the host, over the whole frame if every point moves.
void allMoves(Machine& machine, Scene scene, const std::vector<std::string>& settings, int size) {
  for (Object& object : scene.objects)
    if (!object.sequence) object.motion = RigidMotion{.angularSpeed = 0.5};
  scene.hash = {};
  Bench bench(machine, scene, Pipeline::load("scenes/pipelines/virtual_area_lights.pipeline"), settings,
              size);
  bench.afresh();
  std::vector<double> shares, ms;
  for (int i = 1; i <= machine.repeats; ++i) {
    bench.at(0.1 * i);
    const Times frame = bench.at(0.1 * i + 0.04);
    shares.push_back(frame.at("points") / total(frame));
    ms.push_back(frame.at("points"));
  }
  row(fmt::format("{}, {} x {} pixels, all moves: points over the frame", scene.name, size, size),
      inWords(shares) + ", ms " + inWords(ms));
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const bool quick = argc > 1 && std::string_view(argv[1]) == "--quick";
    Machine machine;
    machine.repeats = quick ? 1 : argc > 1 ? repeatsOf(argv[1], "bench_virtual_area_lights") : 5;
    const Scene cornell = loadScene("scenes/cornell.scene"),
                glossy = loadScene("scenes/cornell_glossy.scene");
    fmt::print("{} repeats in turns, median [quartiles], on {}\n", machine.repeats,
               machine.device.info().renderer);
    const int lights = quick ? 64 : 4096, points = quick ? 64 : 2048;
    for (const int size : {256, 512})
      overBruteForce(machine, glossy, lights, points, quick ? size / 16 : size);
    overReflectiveShadowMaps(machine, cornell, quick ? 16 : 256, quick ? 4 : 64,
                             quick ? std::vector<Setting>{{64, 64, "off"}}
                                   : std::vector<Setting>{{1024, 2048, "on"},
                                                          {1024, 1024, "off"},
                                                          {400, 1024, "off"},
                                                          {400, 512, "off"},
                                                          {200, 256, "off"}});
    methods(machine, glossy, lights, points);
    patch(machine, glossy, lights, points);
    if (quick) {
      growth(machine, glossy, {32, 64, 128}, true, 64);
    } else {
      growth(machine, glossy, {1024, 4096, 16384}, true, 2048);
      growth(machine, glossy, {512, 2048, 8192}, false, 1024);
    }
    for (const int many : quick ? std::vector{128} : std::vector{16384, 65536, 262144})
      manyPoints(machine, glossy, 64, many);
    growthWithPixels(machine, glossy, quick ? 16 : 256);
    pointsOnce(machine, quick ? "cornell" : "dragon", quick ? 64 : 4096);
    allMoves(machine, glossy, settingsOf(quick ? 64 : 1024, points), quick ? 16 : 256);
    if (!quick) allMoves(machine, loadScene("scenes/horse_gallop.scene"), {}, 256);
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_virtual_area_lights: {}\n", error.what());
    return 2;
  }
  return 0;
}
