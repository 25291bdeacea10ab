// The main job from beginning to end.
#include "lumivox/experiment/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <set>

#include "base/process.h"
#include "experiment/choice.h"
#include "experiment/measurer.h"
#include "experiment/plan.h"
#include "lumivox/base/error.h"
#include "lumivox/base/log.h"
#include "lumivox/experiment/voxelizers.h"
#include "lumivox/results/store.h"
#include "lumivox/results/text.h"
#include "lumivox/roofline/peak_rates.h"
#include "results/unfinished_store.h"

namespace lumivox {
namespace {

using namespace experiment;

std::vector<OutputImages> outputImages(std::vector<StoredImage> stored) {
  std::vector<OutputImages> outputs;
  for (StoredImage& one : stored) {
    if (one.reference.empty())
      outputs.push_back({std::move(one.output), std::move(one.component), std::move(one.png), {}});
    else if (!outputs.empty())
      outputs.back().against.push_back({std::move(one.reference), std::move(one.png), one.flip});
  }
  return outputs;
}

/// Time for measuring, from when it is made: after the references.
class Budget {
 public:
  explicit Budget(double seconds) : seconds_(seconds) {}
  double spent() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }
  bool allows(double seconds) const { return seconds_ <= 0.0 || spent() + seconds <= seconds_; }
  /// At most this long it goes on.
  double left(double seconds) const {
    return seconds_ <= 0.0 ? seconds : std::clamp(seconds_ - spent(), 0.0, seconds);
  }

 private:
  double seconds_;  ///< 0: no limit
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// One scene of a report, from its reference to its record.
class SceneReport {
 public:
  SceneReport(gpu::Device& device, TechniqueSet& techniques, const ReportOptions& options,
              ResultsStore& checkpoint, Scene scene, const std::string& shown,
              const std::vector<const LoadedPipeline*>& pipelines)
      : device_(device),
        techniques_(techniques),
        options_(options),
        checkpoint_(checkpoint),
        shown_(shown),
        measurer_(device, techniques, options, checkpoint, std::move(scene), shown, Measurer::Images::kept) {
    for (const LoadedPipeline* loaded : pipelines)
      for (PlannedPoint& planned : pointsFor(*loaded, techniques, options))
        points_.push_back({{loaded, std::move(planned)}});
  }

  /// Of all its points.
  std::vector<std::string> keys() const {
    std::vector<std::string> keys;
    for (const Point& point : points_) keys.push_back(measurer_.key(point.wanted));
    return keys;
  }

  void makeReference() {
    logInformation("{}: reference at {} x {}, {} samples per pixel", shown_, measurer_.width(),
                   measurer_.height(), measurer_.referenceOptions().samplesPerPixel);
    std::vector<WantedPoint> wanted;
    for (const Point& point : points_) wanted.push_back(point.wanted);
    whyNoReference_ = whyFailed([&] { measurer_.makeReference(wanted); });
    if (!whyNoReference_.empty())
      logWarning("{}: its reference could not be made: {}", shown_, whyNoReference_);
    const std::vector<bool> held = measurer_.held(wanted, true);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (held[i]) points_[i].state = State::takenUp;
      if (!whyNoReference_.empty()) points_[i].state = State::withoutReference;
      if (points_[i].state == State::takenUp)
        logInformation("{}: taken up from {}", measurer_.text(wanted[i]), checkpoint_.file().string());
    }
  }

  const Scene& scene() const { return measurer_.scene(); }
  std::size_t missing() const { return count(State::missing); }
  std::size_t takenUp() const { return count(State::takenUp); }

  void measureDefaults(const std::function<void(std::size_t)>& done) {
    std::vector<Point*> defaults;
    for (Point& point : points_)
      if (point.state == State::missing && point.wanted.point.isDefault) defaults.push_back(&point);
    measure(defaults, done);
  }

  /// Of each pipeline in turn the next point, as long as the time allows; false when nothing was left to do.
  /// A point is expected to take as long as the longest of its pipeline's so far.
  bool measureMore(const Budget& budget, const std::function<void(std::size_t)>& done) {
    std::vector<Point*> batch;
    double seconds = 0.0;
    for (bool found = true; found && batch.size() < Measurer::kBatch;) {
      found = false;
      std::set<const LoadedPipeline*> had;
      for (Point& point : points_) {
        if (point.state != State::missing || std::find(batch.begin(), batch.end(), &point) != batch.end() ||
            had.count(point.wanted.loaded) != 0 || batch.size() == Measurer::kBatch)
          continue;
        had.insert(point.wanted.loaded);
        const double expected = secondsOf(*point.wanted.loaded);
        if (!budget.allows(seconds + expected)) continue;
        seconds += expected;
        batch.push_back(&point);
        found = true;
      }
    }
    measure(batch, done);
    return !batch.empty();
  }

  /// With and without leaving out, of every pipeline whose default point works, as long as there is time.
  void measurePrunings(const Budget& budget, const std::function<void()>& atWork) {
    for (const Point& point : points_) {
      atWork();
      if (!point.wanted.point.isDefault || !works(point)) continue;
      if (budget.allows(0.0))
        measurePruning(*point.wanted.loaded);
      else
        leftOutPrunings_.push_back(point.wanted.loaded->shown);
    }
  }

  /// Times points once more: how far apart times of the same thing are here.
  void control(std::size_t most) {
    std::vector<WantedPoint> wanted;
    for (const Point& point : points_)
      if (works(point)) wanted.push_back(point.wanted);
    const std::string why = whyFailed([&] { measurer_.control(wanted, most); });
    if (!why.empty()) logWarning("{}: nothing could be timed twice: {}", shown_, why);
  }

  SceneRecord record(const std::vector<PeakRate>& peakRates, const ResultsStore& controls) {
    const Scene& scene = measurer_.scene();
    SceneRecord record;
    record.file = shown_;
    record.name = scene.name;
    record.hash = scene.hash.text();
    record.camera = scene.camera(options_.camera).name;
    record.time = options_.time;
    record.triangles = scene.triangleCount();
    record.width = measurer_.width();
    record.height = measurer_.height();
    record.referenceSamples = measurer_.referenceOptions().samplesPerPixel;
    for (const Point& point : points_) {
      if (point.state == State::missing)
        record.leftOutPoints.push_back(
            {point.wanted.loaded->shown, point.wanted.point.sweep, point.wanted.point.parameters});
      else
        record.points.push_back(recordOf(point, peakRates));
    }
    record.pruning = std::move(pruning_);
    record.leftOutPrunings = std::move(leftOutPrunings_);
    if (!whyNoReference_.empty()) return record;
    record.referenceSeconds = measurer_.reference().seconds();
    record.referenceAttributes = measurer_.reference().layers().attributes;
    std::set<std::string> used;
    for (const PointRecord& point : record.points)
      for (const ComponentError& error : point.point.errors) used.insert(error.reference);
    record.display = {measurer_.reference().exposure(), options_.tone};
    record.exposureGiven = options_.exposure.has_value();
    record.references = referenceRecords(measurer_.reference(), used, options_.tone);
    record.floor = measurer_.floor(controls);
    return record;
  }

 private:
  enum class State { missing, takenUp, measured, withoutReference };
  struct Point {
    WantedPoint wanted;
    State state = State::missing;
  };

  std::size_t count(State state) const {
    return static_cast<std::size_t>(std::count_if(points_.begin(), points_.end(),
                                                  [&](const Point& point) { return point.state == state; }));
  }

  void measure(const std::vector<Point*>& some, const std::function<void(std::size_t)>& done) {
    std::vector<WantedPoint> wanted;
    for (const Point* point : some) wanted.push_back(point->wanted);
    measurer_.measure(wanted, [&](std::size_t own, std::size_t others) { done(own + others); });
    for (Point* point : some) point->state = State::measured;
  }

  double secondsOf(const LoadedPipeline& loaded) const {
    double most = 0.0;
    for (const Point& point : points_)
      if (point.wanted.loaded == &loaded && point.state == State::measured)
        most = std::max(most, measurer_.secondsOf(point.wanted));
    return most;
  }

  bool works(const Point& point) const {
    if (point.state != State::measured && point.state != State::takenUp) return false;
    const std::optional<StoredRun> run = checkpoint_.find(measurer_.key(point.wanted));
    return run && run->point.failure.empty();
  }

  void measurePruning(const LoadedPipeline& loaded) {
    RenderOptions renderOptions;
    renderOptions.parameters = loaded.settings;
    renderOptions.seed = options_.seed;
    renderOptions.camera = options_.camera;
    renderOptions.width = measurer_.width();
    renderOptions.height = measurer_.height();
    logInformation("{}, {}: with and without leaving out", shown_, loaded.shown);
    const std::string why = whyFailed([&] {
      const MachineLock alone(MachineLock::For::timing);
      PruningRecord pruning =
          lumivox::measurePruning(device_, techniques_, measurer_.scene(), loaded.pipeline, renderOptions,
                                  options_.time, options_.repeats);
      pruning.scene = shown_;
      pruning.pipeline = loaded.shown;
      pruning_.push_back(std::move(pruning));
    });
    if (!why.empty())
      logWarning("{}, {}: the unpruned pipeline could not be measured: {}", shown_, loaded.shown, why);
  }

  PointRecord recordOf(const Point& point, const std::vector<PeakRate>& peakRates) const {
    const StoredRun opened = measurer_.open(point.wanted);
    PointRecord record;
    record.isDefault = point.wanted.point.isDefault;
    record.point = opened.point;
    record.identity = opened.identity;
    if (point.state == State::withoutReference) {
      fail(record.point, "the scene's reference could not be made: " + whyNoReference_);
      return record;
    }
    // Names and command are those of this report, whoever measured the point.
    StoredRun kept = checkpoint_.find(opened.identity.key()).value();
    record.created = kept.created;
    record.point = std::move(kept.point);
    nameAs(record.point, opened.point);
    for (const auto& [pass, work] : record.point.passWork)
      record.point.passBounds[pass] = lowerBounds(work, peakRates);
    record.images = outputImages(checkpoint_.images(opened.identity.key()));
    return record;
  }

  gpu::Device& device_;
  TechniqueSet& techniques_;
  const ReportOptions& options_;
  ResultsStore& checkpoint_;
  std::string shown_, whyNoReference_;
  Measurer measurer_;
  std::vector<Point> points_;  ///< in the order of the pipelines and their sweeps
  std::vector<PruningRecord> pruning_;
  std::vector<std::string> leftOutPrunings_;  ///< pipelines
};

/// Measures all scenes: the default points of all pipelines first, then what leaving out saves; sweeps share
/// what is left of the time.
void measureAll(std::deque<SceneReport>& scenes, const ReportOptions& options, const Budget& budget,
                results::UnfinishedStore& unfinished) {
  std::size_t finished = 0, total = 0;
  for (const SceneReport& scene : scenes) total += scene.missing();
  const auto done = [&](std::size_t points) {
    finished += points;
    unfinished.renew();
    if (!options.progress || points == 0) return;
    const double each = budget.spent() / static_cast<double>(finished);
    options.progress(finished, total, budget.left(each * static_cast<double>(total - finished)));
  };
  for (SceneReport& scene : scenes) scene.measureDefaults(done);
  for (SceneReport& scene : scenes) scene.measurePrunings(budget, [&] { unfinished.renew(); });
  for (bool more = true; more;) {
    more = false;
    for (SceneReport& scene : scenes) more = scene.measureMore(budget, done) || more;
  }
  // Where time is short one point tells of the machine's mood.
  for (SceneReport& scene : scenes) scene.control(options.budgetSeconds > 0.0 ? 1 : Measurer::kBatch);
}

VoxelizerOptions voxelizerOptions(const ReportOptions& options, const SceneRecord& scene) {
  VoxelizerOptions voxels;
  voxels.resolutions = {options.voxelResolution};
  voxels.camera = options.camera;
  voxels.width = scene.width;
  voxels.height = scene.height;
  voxels.time = options.time;
  voxels.seed = options.seed;
  voxels.repeats = options.repeats;
  voxels.openSweeps = options.openSweeps;
  return voxels;
}

}  // namespace

std::filesystem::path unfinishedStoreOf(const std::filesystem::path& page) {
  return std::filesystem::path(page).replace_extension(".unfinished.sqlite");
}

ReportSummary makeReport(gpu::Device& device, TechniqueSet& techniques, const ReportOptions& options,
                         const std::function<Scene(const std::filesystem::path&)>& loadScene,
                         const std::function<void(const ReportRecord&)>& write) {
  ReportSummary summary;
  if (options.scenes.empty()) throw Error("a report needs at least one scene");
  std::optional<ResultsStore> store;
  if (!options.store.empty()) store.emplace(options.store);

  ReportRecord data;
  data.commandLine = options.commandLine;
  data.equalTimesMs = options.equalTimesMs;
  data.equalErrors = options.equalErrors;
  data.budgetSeconds = options.budgetSeconds;
  data.device = device.info();
  data.shaderInput = gpu::programRouteText(device);
  data.host = hostText();
  data.date = dateText();
  data.peakRates = storedPeakRates(device, options.store);

  // Everything that can be wrong in any text is found before the first image is rendered.
  PipelineChoice choice(options, techniques);
  std::vector<Scene> scenes;
  std::vector<std::vector<const LoadedPipeline*>> pipelines;
  std::vector<std::vector<std::pair<std::string, std::string>>> unsuited;
  for (const std::filesystem::path& file : options.scenes) {
    scenes.push_back(loadScene(file));
    scenes.back().camera(options.camera);
    unsuited.emplace_back();
    pipelines.push_back(choice.forScene(scenes.back(), unsuited.back()));
  }

  if (options.allRead) options.allRead();
  results::UnfinishedStore unfinished(unfinishedStoreOf(options.output), options.commandLine);
  ResultsStore& checkpoint = unfinished.store();
  std::deque<SceneReport> reports;  // a measurer stays where it is
  std::vector<std::string> keys;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    reports.emplace_back(device, techniques, options, checkpoint, std::move(scenes[i]),
                         shownPath(options.scenes[i]), pipelines[i]);
    const std::vector<std::string> ofScene = reports.back().keys();
    keys.insert(keys.end(), ofScene.begin(), ofScene.end());
  }
  unfinished.want(keys);
  for (SceneReport& report : reports) {
    report.makeReference();
    unfinished.renew();
    summary.takenUp += report.takenUp();
  }
  const Budget budget(options.budgetSeconds);
  measureAll(reports, options, budget, unfinished);
  data.measuringSeconds = budget.spent();
  if (store) store->merge(checkpoint, unfinished.wanted());
  std::set<std::string> pipelineFiles, techniqueNames;
  for (std::size_t i = 0; i < reports.size(); ++i) {
    data.scenes.push_back(reports[i].record(data.peakRates, store ? *store : checkpoint));
    data.scenes.back().unsuited = unsuited[i];
    if (options.voxelResolution > 0) {
      const std::vector<VoxelizerRecord> voxels = measureVoxelizers(
          device, techniques, reports[i].scene(), voxelizerOptions(options, data.scenes.back()));
      data.voxels.insert(data.voxels.end(), voxels.begin(), voxels.end());
    }
    for (const LoadedPipeline* loaded : pipelines[i]) {
      if (pipelineFiles.insert(loaded->shown).second)
        data.pipelines.push_back({loaded->shown, loaded->pipeline.name, loaded->pipeline.hash.text()});
      for (const std::string& name : loaded->pipeline.techniques()) techniqueNames.insert(name);
    }
  }
  for (const std::string& name : techniqueNames)
    if (const Technique* technique = techniques.technique(name))
      data.techniques.push_back({name, technique->hash.text(), technique->shaders.hash.text(),
                                 technique->meaning, technique->paper});
  data.skipped = techniques.skipped();
  if (store) data.stress = newestCells(store->stressCells());

  write(data);
  unfinished.finish();

  for (SceneRecord& scene : data.scenes) {
    for (PointRecord& point : scene.points) {
      summary.points.push_back(std::move(point.point));
    }
    for (PruningRecord& pruning : scene.pruning) summary.pruning.push_back(std::move(pruning));
    if (!scene.references.empty()) summary.displays.emplace_back(scene.file, scene.display);
    for (const LeftOutPoint& point : scene.leftOutPoints)
      summary.leftOutPoints.push_back(
          fmt::format("{}, {}: {}", scene.file, point.pipeline, pointText(point.parameters)));
    for (const std::string& pipeline : scene.leftOutPrunings)
      summary.leftOutPoints.push_back(
          fmt::format("{}, {}: with and without leaving out", scene.file, pipeline));
    for (const auto& [pipeline, why] : scene.unsuited)
      summary.unsuited.push_back(scene.file + ", " + pipeline + ": " + why);
  }
  return summary;
}

}  // namespace lumivox
