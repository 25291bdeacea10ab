// Voxelizers that miss nothing, against OpenVDB's conversion of a mesh to a narrow band and against loops
// over triangles on the CPU. The repeats alternate in one run, so that a machine that becomes slower does so
// for all.
// usage: bench_voxelization [--quick] [--repeats N] [--resolution R]... [scene texts] (default: 9 repeats,
// 128 and 256, scenes/bunny.scene and scenes/sponza_crytek.scene below the current directory; --quick: one
// repeat at 32 of scenes/cornell.scene). Exit code 2: a voxelizer misses a voxel, or finds other voxels than
// the others.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <functional>
#include <stdexcept>

#include "competitors.h"
#include "lumivox/base/error.h"
#include "lumivox/base/log.h"
#include "lumivox/experiment/voxelizers.h"
#include "lumivox/measure/metrics.h"
#include "lumivox/pipeline/pipeline.h"
#include "lumivox/plugin/loader.h"

namespace {

using namespace lumivox;
using namespace lumivox::bench;

constexpr int kThreads = 2;

struct Candidate {
  std::string name;
  std::function<double()> runMs;
  std::uint64_t made = 0;              ///< fragments, bits or active voxels
  double recall = -1, precision = -1;  ///< negative: it gives no set of voxels
  std::vector<double> ms{};
};

double clocked(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// A voxelizer of the project, by its method.
struct Voxelizer {
  std::string method;
  std::unique_ptr<PipelineExecutor> executor;
};

Voxelizer voxelizer(gpu::Device& device, TechniqueSet& techniques, const Scene& scene, int resolution,
                    const std::string& method) {
  const Pipeline pipeline = Pipeline::parse(
      fmt::format("pipeline \"Conservative voxels, {0}\" {{\n"
                  "  pass voxels voxelization.conservative {{ resolution {1}  method {0} }}\n}}\n",
                  method, resolution),
      "bench_voxelization");
  Voxelizer made{method,
                 std::make_unique<PipelineExecutor>(device, techniques, scene, pipeline, RenderOptions{})};
  made.executor->keepOutput("voxels", "fragments");
  made.executor->render(0.0, 0, PipelineExecutor::Images::no);
  return made;
}

void judge(Candidate& candidate, const VoxelSet& occupied, const VoxelReference& reference) {
  const VoxelError error = compareVoxels(occupied, reference);
  candidate.recall = error.recall();
  candidate.precision = error.precision();
}

VoxelSet voxelsOf(std::span<const Fragment> fragments, const glm::ivec3& resolution) {
  VoxelSet set(resolution);
  for (const Fragment& fragment : fragments)
    set.insert({fragment.voxel & 1023u, fragment.voxel >> 10 & 1023u, fragment.voxel >> 20 & 1023u});
  return set;
}

/// All candidates use the same test, so none may miss or invent a voxel, up to single precision.
void requireRight(const Candidate& candidate) {
  if (candidate.made == 0) throw Error(candidate.name + ": made nothing");
  constexpr double kLeast = 0.999;
  if (candidate.recall >= 0 && std::min(candidate.recall, candidate.precision) < kLeast)
    throw Error(fmt::format("{}: recall {}, precision {}; expected at least {} of both", candidate.name,
                            candidate.recall, candidate.precision, kLeast));
}

void printResults(const std::vector<Candidate>& candidates) {
  const auto medianOf = [&](const char* name) {
    for (const Candidate& candidate : candidates)
      if (candidate.name == name) return statisticsOf(candidate.ms).median;
    throw std::logic_error(name);
  };
  const double bandMs = medianOf("OpenVDB narrow band, 2 threads");
  const double bestListMs =
      std::min(medianOf("CPU fragments, 1 thread"), medianOf("CPU fragments, 2 threads"));
  fmt::print("  {:<32} {:>9} {:>20} {:>10} {:>8} {:>9} {:>12} {:>12}\n", "", "median ms", "quartiles", "made",
             "recall", "precision", "OpenVDB/this", "this/CPU list");
  for (const Candidate& candidate : candidates) {
    const TimingStatistics time = statisticsOf(candidate.ms);
    fmt::print("  {:<32} {:>9.2f} {:>20} {:>10} {:>8} {:>9} {:>11.1f}x {:>11.2f}x\n", candidate.name,
               time.median, fmt::format("[{:.2f}, {:.2f}]", time.lowerQuartile, time.upperQuartile),
               candidate.made, candidate.recall < 0 ? "-" : fmt::format("{:.4f}", candidate.recall),
               candidate.recall < 0 ? "-" : fmt::format("{:.4f}", candidate.precision), bandMs / time.median,
               time.median / bestListMs);
  }
  std::fflush(stdout);
}

void compare(gpu::Device& device, TechniqueSet& techniques, const std::filesystem::path& file, int resolution,
             int repeats) {
  const Scene scene = loadScene(file);
  const SceneSnapshot snapshot = snapshotOf(scene, 0.0);
  std::vector<Voxelizer> voxelizers;
  for (const char* method : {"automatic", "compute", "raster"})
    voxelizers.push_back(voxelizer(device, techniques, scene, resolution, method));
  const auto first = occupiedVoxels(*voxelizers.front().executor->output("voxels", "fragments"));
  const VoxelReference reference = trueVoxels(scene, snapshot, first->grid);
  const Mesh mesh = meshOf(scene, snapshot, first->grid);
  CpuLoops loops(mesh);
  NarrowBand band(mesh);

  std::vector<Candidate> candidates;
  for (Voxelizer& one : voxelizers) {
    PipelineExecutor& executor = *one.executor;
    candidates.push_back({"conservative, " + one.method, [&executor] {
                            executor.invalidate();
                            return executor.render(0.0, 0, PipelineExecutor::Images::no).frameMs;
                          }});
    const auto found = occupiedVoxels(*executor.output("voxels", "fragments"));
    candidates.back().made = found->fragments;
    judge(candidates.back(), found->voxels, reference);
  }
  for (const int threads : {1, kThreads}) {
    const std::string suffix = threads == 1 ? ", 1 thread" : fmt::format(", {} threads", threads);
    candidates.push_back(
        {"CPU fragments" + suffix, [&, threads] { return clocked([&] { loops.fragments(threads); }); }});
    candidates.back().made = loops.fragments(threads);
    judge(candidates.back(), voxelsOf(loops.list(), mesh.grid.resolution), reference);
    candidates.push_back(
        {"CPU bits alone" + suffix, [&, threads] { return clocked([&] { loops.bits(threads); }); }});
    loops.bits(threads);
    candidates.back().made = loops.occupied().count();
    judge(candidates.back(), loops.occupied(), reference);
  }
  candidates.push_back({fmt::format("OpenVDB narrow band, {} threads", kThreads),
                        [&] { return clocked([&] { band.convert(kThreads); }); }});
  candidates.back().made = band.convert(kThreads);

  for (const Candidate& candidate : candidates) requireRight(candidate);
  for (int repeat = 0; repeat < repeats; ++repeat)
    for (Candidate& candidate : candidates) candidate.ms.push_back(candidate.runMs());
  fmt::print("{}, {} triangles, {} x {} x {} voxels, {} repeats\n", file.filename().string(),
             scene.triangleCount(), mesh.grid.resolution.x, mesh.grid.resolution.y, mesh.grid.resolution.z,
             repeats);
  printResults(candidates);
}

int run(int count, char** arguments) {
  int repeats = 9;
  std::vector<int> resolutions;
  std::vector<std::filesystem::path> files;
  for (int i = 1; i < count; ++i) {
    const std::string argument = arguments[i];
    if (argument == "--quick") {
      repeats = 1;
      resolutions = {32};
      files = {"scenes/cornell.scene"};
    } else if (argument == "--repeats" || argument == "--resolution") {
      if (++i == count) throw Error(argument + ": expected a number behind it");
      const int value = std::atoi(arguments[i]);
      if (value < 1 || value > 1024)
        throw Error(fmt::format("{} {}: expected 1..1024", argument, arguments[i]));
      if (argument == "--repeats") repeats = value;
      if (argument == "--resolution") resolutions.push_back(value);
    } else {
      files.emplace_back(argument);
    }
  }
  if (resolutions.empty()) resolutions = {128, 256};
  if (files.empty()) files = {"scenes/bunny.scene", "scenes/sponza_crytek.scene"};
  setLogLevel(LogLevel::quiet);
  gpu::Device device;
  TechniqueSet techniques(TechniqueSet::defaultDirectories({}));
  fmt::print("{}\n", device.info().renderer);
  for (const std::filesystem::path& file : files)
    for (const int resolution : resolutions) {
      try {
        compare(device, techniques, file, resolution, repeats);
      } catch (const AbsentError& absent) {
        fmt::print("{}: left out: {}\n", file.string(), absent.what());
      }
    }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_voxelization: {}\n", error.what());
    return 2;
  }
}
