// Makes a report: the main job from beginning to end.
#include "lumivox/experiment/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <map>
#include <set>

#include "base/process.h"
#include "experiment/budget.h"
#include "experiment/choice.h"
#include "experiment/costs.h"
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

/// One scene of a report, from its reference to its record.
class SceneReport {
 public:
  SceneReport(gpu::Device& device, TechniqueSet& techniques, const ReportOptions& options,
              ResultsStore& checkpoint, Scene scene, const std::string& shown,
              const std::vector<const LoadedPipeline*>& pipelines, const std::shared_ptr<Costs>& costs)
      : device_(device),
        techniques_(techniques),
        options_(options),
        checkpoint_(checkpoint),
        shown_(shown),
        costs_(costs),
        measurer_(device, techniques, options, checkpoint, std::move(scene), shown, Measurer::Images::kept,
                  costs) {
    for (const LoadedPipeline* loaded : pipelines)
      for (PlannedPoint& planned : pointsFor(*loaded, techniques, options))
        points_.push_back({{loaded, std::move(planned)}});
  }

  /// Store keys of all points.
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

  /// Upper estimate of the time, s, of the cheapest missing point among those that were looked at; empty
  /// without any.
  std::optional<double> leastMissingSeconds() {
    std::optional<double> least;
    for (const Point& point : points_)
      if (point.state == State::missing && measurer_.wasLookedAt(point.wanted))
        least = std::min(least.value_or(measurer_.mostSeconds(point.wanted)),
                         measurer_.mostSeconds(point.wanted));
    return least;
  }

  /// Which default points to measure: those of pipelines that bear a technique's name and stand for it, or
  /// the others.
  enum class Defaults { all, ofTechniques, others };

  /// Measures default points batch by batch while there is time. False when none was measured.
  bool measureDefaults(Defaults which, const Budget& budget, const std::function<void(std::size_t)>& done) {
    std::vector<std::pair<double, Point*>> candidates;  // with their expected times, s
    double seconds = 0.0;
    for (Point& point : points_) {
      if (point.state != State::missing || !point.wanted.point.isDefault) continue;
      if (which != Defaults::all && standsForTechnique(point) != (which == Defaults::ofTechniques)) continue;
      // Looking at a further pipeline takes time, too.
      constexpr double kEnough = 0.5;
      if (!budget.allows(which == Defaults::others ? seconds : 0.0) ||
          (which == Defaults::others && budget.isLimited() && seconds > kEnough * budget.left()))
        break;
      candidates.emplace_back(budget.isLimited() ? measurer_.mostSeconds(point.wanted) : 0.0, &point);
      if (budget.allows(seconds + candidates.back().first)) seconds += candidates.back().first;
    }
    // The cheapest first, so that something can soon be seen.
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<Point*> batch;
    seconds = 0.0;
    for (const auto& [expected, point] : candidates) {
      if (budget.isLimited() && (batch.size() == Measurer::kBatch || !budget.allows(seconds + expected)))
        break;
      seconds += expected;
      batch.push_back(point);
    }
    measure(batch, done);
    return !batch.empty();
  }

  /// Measures the next point of each pipeline in turn while there is time; false when nothing was left to do.
  /// A limited time is not spent on pipelines that had no time for their default point.
  bool measureMore(const Budget& budget, const std::function<void(std::size_t)>& done) {
    std::vector<Point*> batch;
    double seconds = 0.0;
    for (bool found = true; found && batch.size() < Measurer::kBatch;) {
      found = false;
      std::set<const LoadedPipeline*> had;
      for (Point& point : points_) {
        if (point.state != State::missing || std::find(batch.begin(), batch.end(), &point) != batch.end() ||
            had.count(point.wanted.loaded) != 0 || batch.size() == Measurer::kBatch ||
            (!measurer_.wasLookedAt(point.wanted) &&
             (defaultIsMissing(*point.wanted.loaded) || !budget.allows(seconds))))
          continue;
        had.insert(point.wanted.loaded);
        const double expected = budget.isLimited() ? measurer_.mostSeconds(point.wanted) : 0.0;
        if (!budget.allows(seconds + expected)) continue;
        seconds += expected;
        batch.push_back(&point);
        found = true;
      }
    }
    measure(batch, done);
    return !batch.empty();
  }

  bool defaultIsMissing(const LoadedPipeline& pipeline) const {
    return std::any_of(points_.begin(), points_.end(), [&](const Point& point) {
      return point.wanted.loaded == &pipeline && point.wanted.point.isDefault &&
             point.state == State::missing;
    });
  }

  /// Compares every pipeline whose default point works with and without leaving out, while there is time:
  /// whether the images are the same, the memory saved and, if `timed`, the time saved.
  void measurePrunings(bool timed, const Budget& budget, const std::function<void()>& atWork) {
    for (const Point& point : points_) {
      atWork();
      const PruningRecord* known = pruningOf(*point.wanted.loaded);
      if (!point.wanted.point.isDefault || !works(point) ||
          (known != nullptr && (known->prunedMs.repeats > 0 || !timed)))
        continue;
      const double planned =
          (timed ? kTimedPruningFrames : kPruningFrames) * measurer_.frameSeconds(point.wanted);
      if (!budget.allows(budget.isLimited() ? planned : 0.0)) continue;
      const double before = budget.spent();
      measurePruning(*point.wanted.loaded, timed ? options_.repeats : 0);
      if (timed) costs_->add(subjectOf(point), kPruningWork, planned, budget.spent() - before);
    }
  }

  /// Looks at every pipeline, so that the costs of points are known before the first is measured.
  void lookAtAll() {
    std::vector<WantedPoint> some;
    for (const Point& point : points_)
      if (point.state == State::missing || (point.wanted.point.isDefault && works(point)))
        some.push_back(point.wanted);
    measurer_.lookAt(some);
  }

  /// Expected time of the remaining points, prunings and controls, s. Work that would end beyond `room` s
  /// does not count.
  double secondsLeft(double room, std::size_t controls) const {
    std::vector<WantedPoint> missing, all;
    for (const Point& point : points_) {
      if (point.state != State::withoutReference) all.push_back(point.wanted);
      if (point.state == State::missing) missing.push_back(point.wanted);
    }
    double left = measurer_.secondsLeft(missing, room);
    for (const Point& point : points_) {
      const PruningRecord* known = pruningOf(*point.wanted.loaded);
      if (!point.wanted.point.isDefault || !measurer_.wasLookedAt(point.wanted) ||
          (known != nullptr && known->prunedMs.repeats > 0))
        continue;
      const double planned = kTimedPruningFrames * measurer_.knownFrameSeconds(point.wanted);
      const double seconds = costs_->expected(subjectOf(point), kPruningWork, planned).value_or(planned);
      if (left + seconds <= room) left += seconds;
    }
    return left + measurer_.controlSeconds(all, controls);
  }

  /// Times points once more, to learn how far repeated times differ on this machine.
  void control(std::size_t most) {
    std::vector<WantedPoint> wanted;
    for (const Point& point : points_)
      if (works(point)) wanted.push_back(point.wanted);
    const std::string why = whyFailed([&] { measurer_.control(wanted, most); });
    if (!why.empty()) logWarning("{}: nothing could be timed twice: {}", shown_, why);
  }

  /// The record so far.
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
    record.pruning = pruning_;
    for (const Point& point : points_)
      if (point.wanted.point.isDefault && works(point)) {
        const PruningRecord* known = pruningOf(*point.wanted.loaded);
        if (known == nullptr || known->prunedMs.repeats == 0)
          record.leftOutPrunings.push_back(point.wanted.loaded->shown);
      }
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

  /// Frames of a comparison with and without leaving out: the warm-ups of both and, where it is timed, three
  /// or more frames of each, whole and by passes, and the following frames.
  static constexpr double kPruningFrames = 4.0, kTimedPruningFrames = 25.0;
  static constexpr const char* kPruningWork = "leaving out";
  std::string subjectOf(const Point& point) const { return shown_ + ", " + point.wanted.loaded->shown; }

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

  /// Whether the pipeline bears a technique's own name.
  bool standsForTechnique(const Point& point) const {
    const Pipeline& pipeline = point.wanted.loaded->pipeline;
    const std::vector<std::string> used = pipeline.techniques();
    return std::find(used.begin(), used.end(), pipeline.file.stem().string()) != used.end();
  }

  const PruningRecord* pruningOf(const LoadedPipeline& loaded) const {
    const auto found = std::find_if(pruning_.begin(), pruning_.end(),
                                    [&](const PruningRecord& one) { return one.pipeline == loaded.shown; });
    return found == pruning_.end() ? nullptr : &*found;
  }

  bool works(const Point& point) const {
    if (point.state != State::measured && point.state != State::takenUp) return false;
    const std::optional<StoredRun> run = checkpoint_.find(measurer_.key(point.wanted));
    return run && run->point.failure.empty();
  }

  void measurePruning(const LoadedPipeline& loaded, int repeats) {
    RenderOptions renderOptions;
    renderOptions.parameters = loaded.settings;
    renderOptions.seed = options_.seed;
    renderOptions.camera = options_.camera;
    renderOptions.width = measurer_.width();
    renderOptions.height = measurer_.height();
    if (repeats > 0) logInformation("{}, {}: with and without leaving out", shown_, loaded.shown);
    const std::string why = whyFailed([&] {
      const MachineLock alone(MachineLock::For::timing);
      PruningRecord pruning = lumivox::measurePruning(device_, techniques_, measurer_.scene(),
                                                      loaded.pipeline, renderOptions, options_.time, repeats);
      pruning.scene = shown_;
      pruning.pipeline = loaded.shown;
      std::erase_if(pruning_, [&](const PruningRecord& one) { return one.pipeline == loaded.shown; });
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
    // Names and command are those of this report, even if another one measured the point.
    StoredRun kept = checkpoint_.find(opened.identity.key()).value();
    record.created = kept.created;
    record.node = kept.node;
    record.seconds = kept.seconds;
    record.before = kept.before;
    record.after = kept.after;
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
  std::shared_ptr<Costs> costs_;
  Measurer measurer_;
  std::vector<Point> points_;  ///< in the order of the pipelines and their sweeps
  std::vector<PruningRecord> pruning_;
};

/// Measures all scenes and calls `published` whenever there are new results. Without a time limit it measures
/// everything. Otherwise it begins with a point of each technique and what each pipeline leaves out, then
/// takes the other default points, the points of sweeps and the time that leaving out saves, and begins
/// nothing that would end too late. Returns the least budget, s, with which another point would have begun,
/// where points are left but none could; else 0.
double measureAll(std::deque<SceneReport>& scenes, const ReportOptions& options, const Budget& budget,
                  results::UnfinishedStore& unfinished, const std::function<void()>& published) {
  std::size_t finished = 0, total = 0;
  for (const SceneReport& scene : scenes) total += scene.missing();
  // One point has to show the machine's drift where time is short.
  const std::size_t controls = budget.isLimited() ? 1 : Measurer::kBatch;
  const auto done = [&](std::size_t points) {
    finished += points;
    unfinished.renew();
    if (!options.progress || points == 0) return;
    double left = 0.0;
    for (const SceneReport& scene : scenes) left += scene.secondsLeft(budget.left() - left, controls);
    options.progress(finished, total, left);
  };
  const auto atWork = [&] { unfinished.renew(); };
  using Defaults = SceneReport::Defaults;
  const auto prune = [&](bool timed) {
    for (SceneReport& scene : scenes) scene.measurePrunings(timed, budget, atWork);
    published();
  };
  if (budget.isLimited()) {
    for (const Defaults which : {Defaults::ofTechniques, Defaults::others}) {
      for (SceneReport& scene : scenes)
        while (scene.measureDefaults(which, budget, done)) published();
      prune(false);
    }
  } else {
    for (SceneReport& scene : scenes) {
      scene.lookAtAll();
      scene.measureDefaults(Defaults::all, budget, done);
    }
    published();
  }
  // No store keeps the time that leaving out saves; measuring it must not take the time of points in every
  // run.
  if (!budget.isLimited()) prune(true);
  const double before = budget.spent();
  for (bool more = true; more;) {
    more = false;
    for (SceneReport& scene : scenes) more = scene.measureMore(budget, done) || more;
    if (more) published();
  }
  double least = 0.0;
  if (budget.isLimited() && finished == 0)
    for (SceneReport& scene : scenes)
      if (const std::optional<double> seconds = scene.leastMissingSeconds())
        least = least == 0.0 ? before + *seconds : std::min(least, before + *seconds);
  if (budget.isLimited()) prune(true);
  for (SceneReport& scene : scenes) scene.control(controls);
  return least;
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
  data.isLook = options.isLook;
  data.device = device.info();
  data.shaderInput = gpu::programRouteText(device);
  data.host = hostText();
  data.date = dateText();
  data.peakRates = storedPeakRates(device, options.store);

  // All texts are checked before the first image is rendered.
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
  std::deque<SceneReport> reports;  // a measurer cannot be moved
  const auto costs = std::make_shared<Costs>();
  std::vector<std::string> keys;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    reports.emplace_back(device, techniques, options, checkpoint, std::move(scenes[i]),
                         shownPath(options.scenes[i]), pipelines[i], costs);
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
  std::set<std::string> pipelineFiles, techniqueNames;
  for (const std::vector<const LoadedPipeline*>& ofScene : pipelines)
    for (const LoadedPipeline* loaded : ofScene) {
      if (pipelineFiles.insert(loaded->shown).second)
        data.pipelines.push_back({loaded->shown, loaded->pipeline.name, loaded->pipeline.hash.text()});
      for (const std::string& name : loaded->pipeline.techniques()) techniqueNames.insert(name);
    }
  for (const std::string& name : techniqueNames)
    if (const Technique* technique = techniques.technique(name))
      data.techniques.push_back({name, technique->hash.text(), technique->shaders.hash.text(),
                                 technique->meaning, technique->paper});
  data.skipped = techniques.skipped();
  // Writes the page with what is known so far.
  const auto writeNow = [&](bool complete) {
    data.complete = complete;
    data.measuringSeconds = budget.spent();
    data.scenes.clear();
    for (std::size_t i = 0; i < reports.size(); ++i) {
      data.scenes.push_back(reports[i].record(data.peakRates, store ? *store : checkpoint));
      data.scenes.back().unsuited = unsuited[i];
    }
    write(data);
  };
  summary.neededSeconds = measureAll(reports, options, budget, unfinished, [&] { writeNow(false); });
  if (store) {
    store->merge(checkpoint, unfinished.wanted());
    data.stress = newestCells(store->stressCells());
  }
  if (options.voxelResolution > 0)
    for (std::size_t i = 0; i < reports.size(); ++i) {
      const std::vector<VoxelizerRecord> voxels =
          measureVoxelizers(device, techniques, reports[i].scene(),
                            voxelizerOptions(options, reports[i].record({}, store ? *store : checkpoint)));
      data.voxels.insert(data.voxels.end(), voxels.begin(), voxels.end());
    }
  writeNow(true);
  // Points without time are measured by the next run; until then the page keeps what it has.
  const bool isWhole = std::all_of(reports.begin(), reports.end(),
                                   [](const SceneReport& report) { return report.missing() == 0; });
  if (isWhole) unfinished.finish();

  for (SceneRecord& scene : data.scenes) {
    for (PointRecord& point : scene.points) {
      summary.points.push_back(std::move(point.point));
    }
    for (PruningRecord& pruning : scene.pruning) summary.pruning.push_back(std::move(pruning));
    if (!scene.references.empty()) summary.displays.emplace_back(scene.file, scene.display);
    summary.leftOutPoints += scene.leftOutPoints.size();
    summary.leftOutPrunings += scene.leftOutPrunings.size();
    for (const auto& [pipeline, why] : scene.unsuited)
      summary.unsuited.push_back(scene.file + ", " + pipeline + ": " + why);
  }
  return summary;
}

}  // namespace lumivox
