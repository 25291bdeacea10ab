// Measures voxelizers: one warm-up frame gives the voxels, the following frames the times.
#include "lumivox/experiment/voxelizers.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <memory>
#include <set>

#include "base/process.h"
#include "experiment/costs.h"
#include "experiment/gathered_voxels.h"
#include "experiment/plan.h"
#include "lumivox/base/error.h"
#include "lumivox/base/log.h"
#include "lumivox/experiment/report.h"
#include "lumivox/pipeline/pass.h"
#include "lumivox/scene/model_animation.h"
#include "lumivox/toolkit/grid_placement.h"

namespace lumivox {

using namespace experiment;

namespace {
constexpr const char* kResolution = "resolution";  // parameter that every voxelizer's text must declare
}

std::optional<std::filesystem::path> committedVoxelizers(const std::filesystem::path& start) {
  const auto scenes = committedScenes(start);
  if (!scenes || !std::filesystem::is_directory(*scenes / "pipelines/voxelizers")) return std::nullopt;
  return *scenes / "pipelines/voxelizers";
}

namespace {

std::vector<std::filesystem::path> pipelineFiles(const VoxelizerOptions& options, const Scene& scene) {
  std::vector<std::filesystem::path> places = options.pipelines, files;
  if (places.empty()) {
    const auto committed = committedVoxelizers(scene.file.parent_path());
    if (!committed)
      throw Error(
          "no folder scenes/pipelines/voxelizers here or above, nor beside the program; name pipelines "
          "with --pipelines");
    places.push_back(*committed);
  }
  for (const std::filesystem::path& place : places) {
    if (!std::filesystem::is_directory(place)) {
      files.push_back(place);
      continue;
    }
    const std::vector<std::filesystem::path> inside = pipelinesIn(place);
    if (inside.empty())
      throw Error(fmt::format("{}: the folder contains no pipeline; expected *.pipeline", place.string()));
    files.insert(files.end(), inside.begin(), inside.end());
  }
  return files;
}

/// Whether some pass reads this output, by its name or by the pass alone.
bool isRead(const Pipeline& pipeline, const std::string& pass, const std::string& port) {
  for (const PassText& other : pipeline.passes)
    for (const dsl::Item& item : other.block->items) {
      if (!item.property) continue;
      for (const dsl::Value& value : item.property->values)
        if (value.kind == dsl::ValueKind::word && (value.text == pass || value.text == pass + "." + port))
          return true;
    }
  return false;
}

/// An output of a voxelizer under measurement. Outputs of one voxelizer at one point share an executor.
struct Candidate {
  VoxelizerRecord record;
  std::shared_ptr<PipelineExecutor> executor;
  std::string pass, port;
  std::vector<double> frameMs;

  /// Renders a frame that makes this output from nothing.
  FrameResult render(double time, bool shared) const {
    if (shared) executor->keepOnly(pass, port);
    executor->invalidate();
    return executor->render(time, 0, PipelineExecutor::Images::no);
  }

  /// Whether its frames were timed often enough, given how long they are.
  bool hasEnough(const VoxelizerOptions& options) const {
    const auto timed = static_cast<int>(frameMs.size());
    return timed >= std::max(1, options.repeatsOfLongFrames) &&
           statisticsOf(frameMs).median > VoxelizerOptions::kLongFrameMs;
  }
};

class Measurement {
 public:
  /// run() is then called for each resolution and each subdivision.
  Measurement(gpu::Device& device, TechniqueSource& techniques, const VoxelizerOptions& options,
              const std::vector<Pipeline>& pipelines)
      : device_(device), techniques_(techniques), options_(options) {
    for (const Pipeline& pipeline : pipelines) shown_.push_back(shownPath(pipeline.file));
    for (const int resolution : options.resolutions) weights_.push_back(weightOf(resolution, 0));
    for (int times = 1; times <= options.subdivisions; ++times)
      weights_.push_back(weightOf(options.resolutions.front(), times));
    total_ = shown_.size() * weights_.size() * (1 + static_cast<std::size_t>(options.repeats));
  }

  /// Measures all voxelizers on one scene at one resolution and appends to `records`.
  void run(const Scene& scene, const std::vector<Pipeline>& pipelines, int resolution, int subdivisions,
           std::vector<VoxelizerRecord>& records) {
    std::vector<Candidate> candidates;
    references_.emplace(scene, options_.time, options_.camera, options_.width, options_.height);
    pipelinesHeld_ = judged_ = 0;
    referenceSeconds_ = 0.0;
    for (const Pipeline& pipeline : pipelines) {
      VoxelizerRecord blank;
      blank.scene = shownPath(scene.file);
      blank.pipeline = shownPath(pipeline.file);
      blank.resolution = resolution;
      blank.triangles = scene.triangleCount();
      blank.subdivisions = subdivisions;
      const double before = referenceSeconds_;
      frameSeconds_ = 0.0;
      const Clock::time_point start = Clock::now();
      add(scene, pipeline, blank, candidates);
      const double judging = secondsSince(start) - (referenceSeconds_ - before);
      costs_.add(blank.pipeline, kJudgedWork, weights_[run_], judging);
      costs_.add(blank.pipeline, kFrameWork, weights_[run_], frameSeconds_);
      ++judged_;
      ++pipelinesHeld_;
      advance(1);
      // Those that take turns are all held at once.
      constexpr std::uint64_t kMostBytes = std::uint64_t{256} << 20;
      std::uint64_t held = 0;
      for (const Candidate& candidate : candidates) held += candidate.record.allocatedBytes;
      if (held > kMostBytes) time(candidates, records);
    }
    time(candidates, records);
    ++run_;
    judged_ = 0;
  }

 private:
  using Clock = std::chrono::steady_clock;
  static double secondsSince(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
  }

  /// Kinds of work of a pipeline at one resolution. Its times consist of frames of each of its outputs.
  static constexpr const char *kJudgedWork = "judged", *kFrameWork = "frame", *kTimesWork = "times";

  /// Costs grow like areas or volumes with the resolution, and with the triangles or not; this lies between.
  static double weightOf(int resolution, int subdivisions) {
    return std::pow(resolution, 2.5) * std::pow(2.0, subdivisions);
  }

  /// Expected remaining time, s. `repeats`: finished repeats of the pipelines that are held.
  double secondsLeft(int repeats) const {
    double left = 0.0;
    for (std::size_t run = run_; run < weights_.size(); ++run) {
      const double weight = weights_[run];
      if (run > run_) left += referenceRate_ * weight;
      for (std::size_t i = 0; i < shown_.size(); ++i) {
        const bool isJudged = run == run_ && i < judged_;
        if (isJudged && i + pipelinesHeld_ < judged_) continue;  // already timed
        if (!isJudged) left += costs_.expected(shown_[i], kJudgedWork, weight).value_or(0.0);
        const double frames = options_.repeats * costs_.expected(shown_[i], kFrameWork, weight).value_or(0.0);
        const double times = costs_.expected(shown_[i], kTimesWork, weight).value_or(frames);
        left += isJudged ? times * (options_.repeats - repeats) / options_.repeats : times;
      }
    }
    return left;
  }

  /// Times these in turns and turns them into records.
  void time(std::vector<Candidate>& candidates, std::vector<VoxelizerRecord>& records) {
    // An executor that alternates between outputs keeps the memory of all of them. One more frame of each
    // allocates it, so that no timed frame waits for memory.
    for (const Candidate& candidate : candidates) {
      if (!candidate.executor || candidate.executor.use_count() == 1) continue;
      candidate.executor->freeUnused(false);
      candidate.render(options_.time, true);
    }
    const MachineLock alone(MachineLock::For::timing);
    std::map<std::string, double> seconds;
    for (int repeat = 0; repeat < options_.repeats; ++repeat) {
      for (Candidate& candidate : candidates) {
        if (!candidate.executor || candidate.hasEnough(options_)) continue;
        const Clock::time_point start = Clock::now();
        candidate.frameMs.push_back(
            candidate.render(options_.time, candidate.executor.use_count() > 1).frameMs);
        seconds[candidate.record.pipeline] += secondsSince(start);
      }
      if (repeat + 1 == options_.repeats)
        for (const auto& [pipeline, all] : seconds) costs_.add(pipeline, kTimesWork, weights_[run_], all);
      advance(pipelinesHeld_, repeat + 1);
    }
    pipelinesHeld_ = 0;
    for (Candidate& candidate : candidates) {
      candidate.record.frameMs = statisticsOf(std::move(candidate.frameMs));
      records.push_back(std::move(candidate.record));
    }
    candidates.clear();
  }

  void advance(std::size_t steps, int repeats = 0) {
    done_ += steps;
    if (options_.progress && steps > 0) options_.progress(done_, total_, secondsLeft(repeats));
  }

  /// The default point and the points of sweeps at this resolution.
  std::vector<PlannedPoint> points(const Pipeline& pipeline, int resolution) const {
    std::vector<std::string> settings = settingsFor(pipeline, options_.settings);
    settings.push_back(fmt::format("{}={}", kResolution, resolution));
    return plannedPoints(pipeline, pipeline.settings(settings), options_.openSweeps);
  }

  RenderOptions renderOptions(const ParameterValues& parameters) const {
    RenderOptions render;
    render.parameters = parameters;
    render.seed = options_.seed;
    render.camera = options_.camera;
    render.width = options_.width;
    render.height = options_.height;
    return render;
  }

  /// Adds the candidates of a pipeline: its outputs with voxels that no other pass reads.
  void add(const Scene& scene, const Pipeline& pipeline, const VoxelizerRecord& blank,
           std::vector<Candidate>& candidates) {
    const auto skip = [&](const std::string& why) {
      logWarning("{}: {}", blank.pipeline, why);
      candidates.push_back({blank, nullptr, {}, {}, {}});
      candidates.back().record.whyNot = why;
    };
    if (!std::any_of(pipeline.parameters.begin(), pipeline.parameters.end(),
                     [](const PipelineParameter& parameter) { return parameter.name == kResolution; }))
      return skip("it has no parameter 'resolution'");
    try {
      for (const PlannedPoint& point : points(pipeline, blank.resolution)) {
        VoxelizerRecord record = blank;
        record.parameters = point.parameters;
        record.isDefault = point.isDefault;
        if (!addPoint(scene, pipeline, record, candidates))
          return skip("it makes no voxels: there is no output of " + kindsText());
      }
    } catch (const DiagnosticsError&) {
      throw;  // a wrong text
    } catch (const Error& error) {
      skip(error.what());
    }
  }

  /// False where no output holds voxels.
  bool addPoint(const Scene& scene, const Pipeline& pipeline, const VoxelizerRecord& blank,
                std::vector<Candidate>& candidates) {
    const RenderOptions render = renderOptions(blank.parameters);
    const auto executor = std::make_shared<PipelineExecutor>(device_, techniques_, scene, pipeline, render);
    bool any = false;
    for (const PassText& pass : pipeline.passes)
      for (const OutBase* output : executor->pass(pass.name).outputs()) {
        if (!holdsVoxels(output->kind()) || isRead(pipeline, pass.name, output->name())) continue;
        any = true;
        candidates.push_back({blank, nullptr, pass.name, output->name(), {}});
        candidates.back().record.output = pass.name + "." + output->name();
        candidates.back().record.kind = output->kind().name;
        start(executor, candidates.back());
      }
    return any;
  }

  static std::string kindsText() {
    std::vector<std::string> names;
    for (const PortKind* kind : FrameworkPorts::kinds())
      if (holdsVoxels(*kind)) names.push_back(kind->name);
    return fmt::format("a kind that contains voxels ({}) that no other pass reads", fmt::join(names, ", "));
  }

  /// Renders the warm-up frame and judges its voxels.
  void start(const std::shared_ptr<PipelineExecutor>& executor, Candidate& candidate) {
    VoxelizerRecord& record = candidate.record;
    const auto giveUp = [&](const std::string& why) {
      logWarning("{}: {}: {}", record.pipeline, record.output, why);
      record.whyNot = why;
    };
    logInformation("{}, {}, resolution {}", record.scene, record.pipeline, record.resolution);
    try {
      executor->keepOnly(candidate.pass, candidate.port);
      executor->invalidate();
      frameSeconds_ += executor->render(options_.time, 0, PipelineExecutor::Images::no).frameMs / 1000.0;
      const OutBase* output = executor->output(candidate.pass, candidate.port);
      if (output == nullptr) return giveUp("the scene does not have what it needs");
      const auto found = occupiedVoxels(*output);
      record.grid = found->grid;
      record.fragments = found->fragments;
      record.bytes = found->bytes;
      record.occupied = found->voxels.count();
      record.allocatedBytes = executor->explain().poolBytes;
      const Clock::time_point start = Clock::now();
      const VoxelReferences::InGrid& reference = references_->in(found->grid);
      referenceSeconds_ += secondsSince(start);
      referenceRate_ = std::max(referenceRate_, referenceSeconds_ / weights_[run_]);
      record.reference = reference.voxels.certain.count();
      record.undecided = reference.voxels.possible.count() - record.reference;
      record.error = compareVoxels(found->voxels, reference.voxels);
      record.holes = reference.crossings.holes(found->voxels);
      candidate.executor = executor;
    } catch (const DiagnosticsError&) {
      throw;
    } catch (const Error& error) {
      giveUp(error.what());
    }
  }

  gpu::Device& device_;
  TechniqueSource& techniques_;
  const VoxelizerOptions& options_;
  std::optional<VoxelReferences> references_;  ///< of the scene and time at hand
  std::size_t done_ = 0, total_ = 0;           ///< steps
  /// Finished calls of run(); in the current one, the pipelines that are judged, and those of them whose
  /// repeats are still to come.
  std::size_t run_ = 0, judged_ = 0, pipelinesHeld_ = 0;
  std::vector<std::string> shown_;
  std::vector<double> weights_;  ///< one for each run()
  Costs costs_;
  /// Times in the current run(): the exact overlap, which is made once for all pipelines of one grid; the
  /// most that it took for a weight of 1; and a frame of each output of the current pipeline.
  double referenceSeconds_ = 0.0, referenceRate_ = 0.0, frameSeconds_ = 0.0;
};

void requireGood(const VoxelizerOptions& options) {
  for (const int resolution : options.resolutions)
    if (resolution < 1 || resolution > kLargestGrid)
      throw Error(fmt::format("--resolution {}: expected 1..{}", resolution, kLargestGrid));
  constexpr int kMostSubdivisions = 4;  // 256 times the triangles
  if (options.subdivisions < 0 || options.subdivisions > kMostSubdivisions)
    throw Error(fmt::format("{} subdivisions: expected 0..{}", options.subdivisions, kMostSubdivisions));
}

}  // namespace

std::vector<VoxelizerRecord> measureVoxelizers(gpu::Device& device, TechniqueSource& techniques,
                                               const Scene& scene, const VoxelizerOptions& options) {
  requireGood(options);
  scene.camera(options.camera);
  std::vector<Pipeline> pipelines;
  for (const std::filesystem::path& file : pipelineFiles(options, scene)) {
    pipelines.push_back(Pipeline::load(file));
    checkPipeline(pipelines.back(), techniques);
  }
  for (const std::string& setting : options.settings)
    if (std::none_of(pipelines.begin(), pipelines.end(),
                     [&](const Pipeline& pipeline) { return !settingsFor(pipeline, {setting}).empty(); }))
      pipelines.front().settings({setting});  // throws with the known names
  std::vector<VoxelizerRecord> records;
  Measurement measurement(device, techniques, options, pipelines);
  for (const int resolution : options.resolutions) measurement.run(scene, pipelines, resolution, 0, records);
  Scene finer = options.subdivisions > 0 ? subdivided(scene) : Scene();
  for (int times = 1; times <= options.subdivisions; ++times) {
    measurement.run(finer, pipelines, options.resolutions.front(), times, records);
    if (times < options.subdivisions) finer = subdivided(finer);
  }
  return records;
}

Scene subdivided(const Scene& scene) {
  Scene finer = scene;
  finer.positions.clear();
  finer.normals.clear();
  finer.texcoords.clear();
  finer.indices.clear();
  for (Object& object : finer.objects) {
    if (deforms(object))
      throw Error(fmt::format("{}: object '{}' deforms, so that its triangles cannot be split",
                              scene.file.string(), object.name));
    object.firstVertex = static_cast<std::uint32_t>(finer.positions.size());
    for (Part& part : object.parts) {
      const std::uint32_t firstIndex = part.firstIndex, indexCount = part.indexCount;
      part.firstIndex = static_cast<std::uint32_t>(finer.indices.size());
      for (std::uint32_t i = 0; i < indexCount; i += 3) {
        const auto base = static_cast<std::uint32_t>(finer.positions.size());
        const auto add = [&](std::uint32_t a, std::uint32_t b) {
          const std::uint32_t ia = scene.indices[firstIndex + i + a], ib = scene.indices[firstIndex + i + b];
          finer.positions.push_back(0.5f * (scene.positions[ia] + scene.positions[ib]));
          const glm::vec3 normal = scene.normals[ia] + scene.normals[ib];
          finer.normals.push_back(glm::length(normal) > 0.0f ? glm::normalize(normal) : scene.normals[ia]);
          finer.texcoords.push_back(0.5f * (scene.texcoords[ia] + scene.texcoords[ib]));
        };
        // The corners, then the middle of the edge opposite each.
        add(0, 0), add(1, 1), add(2, 2), add(1, 2), add(2, 0), add(0, 1);
        for (const std::uint32_t k : {0u, 5u, 4u, 5u, 1u, 3u, 4u, 3u, 2u, 3u, 4u, 5u})
          finer.indices.push_back(base + k);
      }
      part.indexCount = static_cast<std::uint32_t>(finer.indices.size()) - part.firstIndex;
    }
    object.vertexCount = static_cast<std::uint32_t>(finer.positions.size()) - object.firstVertex;
  }
  return finer;
}

}  // namespace lumivox
