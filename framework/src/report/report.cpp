// The main job from beginning to end.
#include "lumivox/report/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/log.h"
#include "lumivox/report/device.h"
#include "lumivox/report/stress_cells.h"
#include "report/choice.h"
#include "report/measure.h"
#include "report/plan.h"

namespace lumivox {
namespace {

using namespace report;

PointRecord measurePoint(const MeasureContext& context, TechniqueSet& techniques,
                         const LoadedPipeline& loaded, const PlannedPoint& planned,
                         const std::string& sceneShown, int samples,
                         const std::vector<DeviceCeiling>& ceilings, ResultsStore* store) {
  StoredRun run = storedRunOf(context.device, techniques, context.scene, loaded, planned, context.options,
                              context.width, context.height, samples, sceneShown);
  PointRecord record;
  record.isDefault = planned.isDefault;
  record.point = run.point;
  logInformation("{}, {}: {}", sceneShown, loaded.shown, pointText(planned.parameters));
  try {
    measureErrors(context, loaded.pipeline, record);
    measureFlicker(context, loaded.pipeline, record);
    measureTimes(context, loaded.pipeline, record);
    countWork(context, loaded.pipeline, ceilings, record.point);
  } catch (const DiagnosticsError&) {
    throw;  // a wrong text is wrong at every point
  } catch (const Error& error) {
    // One point that does not fit into memory, say, must not cost the others.
    record.point.failure = error.what();
    logWarning("{}, {}, {}: {}", sceneShown, loaded.shown, pointText(planned.parameters), error.what());
  }
  if (store != nullptr) {
    run.created = dateText();
    run.point = record.point;
    store->add(run);
  }
  return record;
}

SceneRecord measureScene(gpu::Device& device, TechniqueSet& techniques, const ReportOptions& options,
                         const Scene& scene, const std::vector<const LoadedPipeline*>& pipelines,
                         const std::string& shown, const std::vector<DeviceCeiling>& ceilings,
                         ResultsStore* store) {
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
  Truth truth(scene, truthOptions);
  record.truthSamples = truthOptions.samplesPerPixel;
  record.truthSeconds = truth.seconds();
  record.truthAttributes = truth.layers().attributes;

  const MeasureContext context{{device, techniques, scene, options, record.width, record.height}, truth};
  for (const LoadedPipeline* loaded : pipelines) {
    bool defaultWorks = true;
    for (const PlannedPoint& planned :
         plannedPoints(loaded->pipeline, loaded->settings, options.openSweeps)) {
      record.points.push_back(measurePoint(context, techniques, *loaded, planned, shown,
                                           truthOptions.samplesPerPixel, ceilings, store));
      if (planned.isDefault) defaultWorks = record.points.back().point.failure.empty();
    }
    if (!defaultWorks) continue;
    RenderOptions renderOptions;
    renderOptions.parameters = loaded->settings;
    renderOptions.seed = options.seed;
    renderOptions.camera = options.camera;
    renderOptions.width = record.width;
    renderOptions.height = record.height;
    logInformation("{}, {}: with and without leaving out", shown, loaded->shown);
    try {
      PruningRecord pruning = measurePruning(device, techniques, scene, loaded->pipeline, renderOptions,
                                             options.time, options.repeats);
      pruning.scene = shown;
      pruning.pipeline = loaded->shown;
      record.pruning.push_back(std::move(pruning));
    } catch (const Error& error) {
      logWarning("{}, {}: the unpruned pipeline could not be measured: {}", shown, loaded->shown,
                 error.what());
    }
  }

  std::set<std::string> used;
  for (const PointRecord& point : record.points)
    for (const ComponentError& error : point.point.errors) used.insert(error.truth);
  record.truths = truthRecords(truth, used);
  record.comparisons = compareComponents(pointsOf(record), {std::begin(kPageMetrics), std::end(kPageMetrics)},
                                         {options.equalTimesMs, options.equalErrors});
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
                         const std::function<Scene(const std::filesystem::path&)>& loadScene) {
  ReportSummary summary;
  summary.page = options.output;
  summary.csv = std::filesystem::path(options.output).replace_extension(".csv");
  summary.json = std::filesystem::path(options.output).replace_extension(".json");
  if (summary.page == summary.csv || summary.page == summary.json)
    throw Error(summary.page.string() +
                ": the page cannot have the extension of the files beside it; use .html");
  if (options.scenes.empty()) throw Error("a report needs at least one scene");
  for (const auto& file : {summary.page, summary.csv, summary.json}) requireWritable(file);
  const std::string library = chartLibrary();
  std::optional<ResultsStore> store;
  if (!options.store.empty()) store.emplace(options.store);

  ReportData data;
  data.options = options;
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

  std::set<std::string> pipelineFiles, techniqueNames;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    data.scenes.push_back(measureScene(device, techniques, options, scenes[i], pipelines[i],
                                       shownPath(options.scenes[i]), data.ceilings,
                                       store ? &*store : nullptr));
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

  writeFileAtomically(summary.json,
                      toJson(data).dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  writeFileAtomically(summary.csv, toCsv(data));
  writeFileAtomically(summary.page, toHtml(data, library));

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
