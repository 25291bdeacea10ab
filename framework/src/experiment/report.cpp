// The main job from beginning to end.
#include "lumivox/experiment/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "base/process.h"
#include "experiment/choice.h"
#include "experiment/measure.h"
#include "experiment/plan.h"
#include "lumivox/base/error.h"
#include "lumivox/base/log.h"
#include "lumivox/experiment/voxelisers.h"
#include "lumivox/results/store.h"
#include "lumivox/results/stress_cells.h"
#include "lumivox/results/text.h"
#include "lumivox/roofline/ceilings.h"

namespace lumivox {
namespace {

using namespace experiment;

std::vector<StoredPicture> storedPictures(const std::vector<OutputPictures>& outputs) {
  std::vector<StoredPicture> stored;
  for (const OutputPictures& one : outputs) {
    stored.push_back({one.output, one.component, {}, 0.0, one.picture});
    for (const OutputPictures::Against& map : one.against)
      stored.push_back({one.output, one.component, map.truth, map.flip, map.flipMap});
  }
  return stored;
}

std::vector<OutputPictures> outputPictures(std::vector<StoredPicture> stored) {
  std::vector<OutputPictures> outputs;
  for (StoredPicture& one : stored) {
    if (one.truth.empty())
      outputs.push_back({std::move(one.output), std::move(one.component), std::move(one.png), {}});
    else if (!outputs.empty())
      outputs.back().against.push_back({std::move(one.truth), std::move(one.png), one.flip});
  }
  return outputs;
}

/// Measures the points of a report, and keeps each as soon as it is there.
class ReportPoints {
 public:
  ReportPoints(TechniqueSet& techniques, const std::vector<DeviceCeiling>& ceilings, ResultsStore& checkpoint,
               ResultsStore* store)
      : techniques_(techniques), ceilings_(ceilings), checkpoint_(checkpoint), store_(store) {}

  /// From the checkpoint where an interrupted report has left it there. Without a truth it fails with the
  /// reason for that.
  PointRecord point(const MeasureContext& context, const LoadedPipeline& loaded, const PlannedPoint& planned,
                    const std::string& sceneShown, int samples) {
    StoredRun run = runOf(context, loaded, planned, sceneShown, samples);
    PointRecord record;
    record.isDefault = planned.isDefault;
    record.point = run.point;
    const std::string text =
        fmt::format("{}, {}: {}", sceneShown, loaded.shown, pointText(planned.parameters));
    if (std::optional<StoredRun> kept = checkpoint_.find(run.identity.key());
        kept && kept->point.failure.empty()) {
      logInformation("{}: taken up from {}", text, checkpoint_.file().string());
      ++takenUp_;
      takeUp(record, std::move(*kept));
    } else {
      logInformation("{}", text);
      if (const std::string why = whyFailed([&] { measure(context, loaded, record); }); !why.empty()) {
        fail(record.point, why);
        record.pictures.clear();
        logWarning("{}: {}", text, why);
      }
      run.created = dateText();
      run.point = record.point;
      checkpoint_.add(run, storedPictures(record.pictures));
    }
    run.created = run.created.empty() ? dateText() : run.created;
    run.point = record.point;
    if (store_ != nullptr) store_->add(run);
    return record;
  }

  /// A point whose truth could not be made.
  static PointRecord failed(const StoredRun& run, bool isDefault, const std::string& why) {
    PointRecord record;
    record.isDefault = isDefault;
    record.point = run.point;
    fail(record.point, why);
    return record;
  }

  StoredRun runOf(const TimingContext& context, const LoadedPipeline& loaded, const PlannedPoint& planned,
                  const std::string& sceneShown, int samples) const {
    return storedRunOf(context.device, techniques_, context.scene, loaded, planned, context.options,
                       context.width, context.height, samples, sceneShown);
  }

  /// Times a point of this report once more, and tells how far apart times of the same thing are here.
  TimeFloor control(const TimingContext& context, const LoadedPipeline& loaded, const PlannedPoint& planned,
                    const std::string& sceneShown, int samples) {
    const StoredRun run = runOf(context, loaded, planned, sceneShown, samples);
    PointRecord again;
    again.point = run.point;
    const std::string why = whyFailed([&] {
      const MachineLock alone(MachineLock::For::timing);
      measureTimes(context, loaded.pipeline, again);
    });
    if (!why.empty()) logWarning("{}, {}: it could not be timed twice: {}", sceneShown, loaded.shown, why);
    for (ResultsStore* store : {&checkpoint_, store_})
      if (store != nullptr && why.empty())
        store->addControl(run.identity.key(), again.point.frameMs, again.point.nextFrameMs);
    // The store of the user holds those of the checkpoint too.
    return timeFloorOf((store_ != nullptr ? *store_ : checkpoint_).controls(run.identity));
  }

  std::size_t takenUp() const { return takenUp_; }

 private:
  void measure(const MeasureContext& context, const LoadedPipeline& loaded, PointRecord& record) {
    {
      const MachineLock working(MachineLock::For::work);
      measureErrors(context, loaded.pipeline, record);
      measureFlicker(context, loaded.pipeline, record);
      countWork(context, loaded.pipeline, ceilings_, record.point);
    }
    const MachineLock alone(MachineLock::For::timing);
    measureTimes(context, loaded.pipeline, record);
  }

  void takeUp(PointRecord& record, StoredRun kept) const {
    const std::string command = record.point.command;
    const std::string scene = record.point.scene, pipeline = record.point.pipeline;
    record.point = std::move(kept.point);
    record.point.scene = scene;
    record.point.pipeline = pipeline;
    record.point.command = command;
    for (const auto& [pass, work] : record.point.passWork)
      record.point.passBounds[pass] = lowerBounds(work, ceilings_);
    if (record.point.passWork.empty())
      record.point.whyNotCounted = "nothing was counted before the report was interrupted";
    record.pictures = outputPictures(checkpoint_.pictures(kept.identity.key()));
  }

  TechniqueSet& techniques_;
  const std::vector<DeviceCeiling>& ceilings_;
  ResultsStore& checkpoint_;
  ResultsStore* store_;
  std::size_t takenUp_ = 0;
};

/// Where points stay until the page is written: a store beside it, which goes when it is of no more use.
class Checkpoint {
 public:
  explicit Checkpoint(const std::filesystem::path& page)
      : store(std::filesystem::path(page).replace_extension(".unfinished.sqlite")) {}
  ~Checkpoint() {
    try {
      if (!finished && !store.runs().empty()) return;
      std::filesystem::remove(store.file());
    } catch (const std::exception& error) {
      logWarning("{}: it is of no more use, and cannot be removed: {}", store.file().string(), error.what());
    }
  }
  Checkpoint(const Checkpoint&) = delete;
  Checkpoint& operator=(const Checkpoint&) = delete;

  ResultsStore store;
  bool finished = false;
};

SceneRecord measureScene(gpu::Device& device, TechniqueSet& techniques, const ReportOptions& options,
                         const Scene& scene, const std::vector<const LoadedPipeline*>& pipelines,
                         const std::string& shown, ReportPoints& points) {
  SceneRecord record;
  record.file = shown;
  record.name = scene.name;
  record.hash = scene.hash.text();
  record.camera = scene.camera(options.camera).name;
  record.time = options.time;
  record.triangles = scene.triangleCount();
  std::tie(record.width, record.height) = measuredSize(device, scene, options);
  const ReferenceOptions truthOptions = truthOptionsOf(options, record.width, record.height);
  logInformation("{}: truth at {} x {}, {} samples per pixel", shown, record.width, record.height,
                 truthOptions.samplesPerPixel);
  record.truthSamples = truthOptions.samplesPerPixel;
  const TimingContext timing{device, techniques, scene, options, record.width, record.height};
  std::optional<Truth> made;
  const std::string whyNoTruth = whyFailed([&] {
    const MachineLock working(MachineLock::For::work);
    made.emplace(scene, truthOptions);
  });
  if (!made) {
    logWarning("{}: its truth could not be made: {}", shown, whyNoTruth);
    for (const LoadedPipeline* loaded : pipelines)
      for (const PlannedPoint& planned :
           plannedPoints(loaded->pipeline, loaded->settings, options.openSweeps))
        record.points.push_back(
            ReportPoints::failed(points.runOf(timing, *loaded, planned, shown, record.truthSamples),
                                 planned.isDefault, "the scene's truth could not be made: " + whyNoTruth));
    return record;
  }
  Truth& truth = *made;
  record.truthSeconds = truth.seconds();
  record.truthAttributes = truth.layers().attributes;

  const MeasureContext context{timing, truth};
  std::optional<std::pair<const LoadedPipeline*, PlannedPoint>> first;
  for (const LoadedPipeline* loaded : pipelines) {
    bool defaultWorks = true;
    for (const PlannedPoint& planned :
         plannedPoints(loaded->pipeline, loaded->settings, options.openSweeps)) {
      record.points.push_back(points.point(context, *loaded, planned, shown, record.truthSamples));
      const bool works = record.points.back().point.failure.empty();
      if (works && !first) first.emplace(loaded, planned);
      if (planned.isDefault) defaultWorks = works;
    }
    if (!defaultWorks) continue;
    RenderOptions renderOptions;
    renderOptions.parameters = loaded->settings;
    renderOptions.seed = options.seed;
    renderOptions.camera = options.camera;
    renderOptions.width = record.width;
    renderOptions.height = record.height;
    logInformation("{}, {}: with and without leaving out", shown, loaded->shown);
    const std::string why = whyFailed([&] {
      const MachineLock alone(MachineLock::For::timing);
      PruningRecord pruning = measurePruning(device, techniques, scene, loaded->pipeline, renderOptions,
                                             options.time, options.repeats);
      pruning.scene = shown;
      pruning.pipeline = loaded->shown;
      record.pruning.push_back(std::move(pruning));
    });
    if (!why.empty())
      logWarning("{}, {}: the unpruned pipeline could not be measured: {}", shown, loaded->shown, why);
  }

  std::set<std::string> used;
  for (const PointRecord& point : record.points)
    for (const ComponentError& error : point.point.errors) used.insert(error.truth);
  record.truths = truthRecords(truth, used);
  if (first) record.floor = points.control(timing, *first->first, first->second, shown, record.truthSamples);
  return record;
}

}  // namespace

namespace {

VoxeliserOptions voxeliserOptions(const ReportOptions& options, const SceneRecord& scene) {
  VoxeliserOptions voxels;
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
  data.device = device.info();
  data.shaderInput = gpu::programRouteText(device);
  data.host = hostText();
  data.date = dateText();
  data.ceilings = storedCeilings(device, options.store);

  // Everything that can be wrong in any text is found before the first picture is rendered.
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

  Checkpoint checkpoint(options.output);
  ReportPoints points(techniques, data.ceilings, checkpoint.store, store ? &*store : nullptr);
  std::set<std::string> pipelineFiles, techniqueNames;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    data.scenes.push_back(measureScene(device, techniques, options, scenes[i], pipelines[i],
                                       shownPath(options.scenes[i]), points));
    data.scenes.back().unsuited = unsuited[i];
    if (options.voxelResolution > 0) {
      const std::vector<VoxeliserRecord> voxels =
          measureVoxelisers(device, techniques, scenes[i], voxeliserOptions(options, data.scenes.back()));
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
  checkpoint.finished = true;
  summary.takenUp = points.takenUp();

  for (SceneRecord& scene : data.scenes) {
    for (PointRecord& point : scene.points) {
      summary.points.push_back(std::move(point.point));
    }
    for (PruningRecord& pruning : scene.pruning) summary.pruning.push_back(std::move(pruning));
    for (const auto& [pipeline, why] : scene.unsuited)
      summary.unsuited.push_back(scene.file + ", " + pipeline + ": " + why);
  }
  return summary;
}

}  // namespace lumivox
