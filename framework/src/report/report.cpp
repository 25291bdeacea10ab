// The main job from beginning to end.
#include "lumivox/report/report.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <set>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/log.h"
#include "report/measure.h"
#include "report/plan.h"

namespace lumivox {
namespace {

using namespace report;

/// Longest side of the pictures on a software rasteriser, where a frame at the camera's resolution takes too
/// long to repeat.
constexpr int kSoftwarePixels = 128;

struct LoadedPipeline {
  Pipeline pipeline;
  std::string shown;
  ParameterValues settings;
};

std::string hostText() {
  utsname system{};
  uname(&system);
  std::string processor;
  std::ifstream information("/proc/cpuinfo");
  for (std::string line; processor.empty() && std::getline(information, line);)
    if (line.rfind("model name", 0) == 0 && line.find(": ") != std::string::npos)
      processor = line.substr(line.find(": ") + 2);
  return fmt::format("{} {} {}, {} x {}", system.sysname, system.release, system.machine,
                     sysconf(_SC_NPROCESSORS_ONLN), processor.empty() ? "processor" : processor);
}

/// All pipelines of a scene: those given, or every committed one.
class PipelineChoice {
 public:
  PipelineChoice(const ReportOptions& options, TechniqueSet& techniques)
      : options_(options), techniques_(techniques) {
    for (const std::filesystem::path& file : options.pipelines) given_.push_back(load(file));
    for (const LoadedPipeline& one : given_) checkPipeline(one.pipeline, techniques);
    requireKnownSettings(given_);
  }

  std::vector<const LoadedPipeline*> forScene(const Scene& scene,
                                              std::vector<std::pair<std::string, std::string>>& unsuited) {
    std::vector<const LoadedPipeline*> chosen;
    if (!options_.pipelines.empty()) {
      for (const LoadedPipeline& one : given_) chosen.push_back(&one);
      return chosen;
    }
    const auto folder = committedScenes(scene.file.parent_path());
    if (!folder)
      throw Error(fmt::format(
          "{}: no folder 'pipelines' beside the scene and no project around here; name one with --pipeline",
          scene.file.string()));
    std::vector<LoadedPipeline>& all = committed_[*folder];
    if (all.empty()) {
      for (const std::filesystem::path& file : pipelinesIn(*folder / "pipelines")) all.push_back(load(file));
      requireKnownSettings(all);
    }
    const SceneTraits traits = SceneTraits::of(scene);
    for (const LoadedPipeline& one : all) {
      std::string why = missingTechnique(one.pipeline);
      if (why.empty()) {
        checkPipeline(one.pipeline, techniques_);
        why = whyUnsuited(one.pipeline, techniques_, traits);
        if (!why.empty()) why += ", which the scene does not have";
      }
      if (why.empty())
        chosen.push_back(&one);
      else
        unsuited.emplace_back(one.shown, why);
    }
    if (chosen.empty())
      throw Error(fmt::format(
          "{}: no pipeline in {} suits this scene{}", scene.file.string(), (*folder / "pipelines").string(),
          unsuited.empty() ? std::string() : "; the first one: " + unsuited.front().second));
    return chosen;
  }

 private:
  LoadedPipeline load(const std::filesystem::path& file) {
    LoadedPipeline loaded{Pipeline::load(file), shownPath(file), {}};
    loaded.settings = loaded.pipeline.settings(settingsFor(loaded.pipeline, options_.settings));
    return loaded;
  }

  /// A setting that no pipeline knows is a slip of the pen.
  void requireKnownSettings(const std::vector<LoadedPipeline>& pipelines) {
    for (const std::string& setting : options_.settings) {
      const auto knows = [&](const LoadedPipeline& one) {
        return !settingsFor(one.pipeline, {setting}).empty();
      };
      if (!pipelines.empty() && std::none_of(pipelines.begin(), pipelines.end(), knows))
        pipelines.front().pipeline.settings({setting});
    }
  }

  std::string missingTechnique(const Pipeline& pipeline) {
    for (const std::string& name : pipeline.techniques()) {
      if (techniques_.technique(name) != nullptr) continue;
      for (const SkippedTechnique& skipped : techniques_.skipped())
        if (skipped.library.stem() == "lib" + name || skipped.library.stem() == name)
          return fmt::format("its technique '{}' was skipped: {}", name, skipped.reason);
      return fmt::format("its technique '{}' is not among the technique libraries", name);
    }
    return {};
  }

  const ReportOptions& options_;
  TechniqueSet& techniques_;
  std::vector<LoadedPipeline> given_;
  std::map<std::filesystem::path, std::vector<LoadedPipeline>> committed_;
};

std::string pointText(const ParameterValues& parameters) {
  std::string text;
  for (const auto& [name, value] : parameters) text += (text.empty() ? "" : " ") + name + "=" + value.text();
  return text.empty() ? "default" : text;
}

PointRecord measurePoint(const MeasureContext& context, const LoadedPipeline& loaded,
                         const PlannedPoint& planned, const std::string& sceneShown, int samples) {
  PointRecord record;
  record.isDefault = planned.isDefault;
  record.point.scene = sceneShown;
  record.point.pipeline = loaded.shown;
  record.point.sweep = planned.sweep;
  record.point.parameters = planned.parameters;
  record.point.command = repeatingCommand(context.options, sceneShown, loaded.shown, planned.parameters,
                                          context.width, context.height, samples);
  logInformation("{}, {}: {}", sceneShown, loaded.shown, pointText(planned.parameters));
  try {
    measureErrors(context, loaded.pipeline, record);
    measureTimes(context, loaded.pipeline, record);
  } catch (const DiagnosticsError&) {
    throw;  // a wrong text is wrong at every point
  } catch (const Error& error) {
    // One point that does not fit into memory, say, must not cost the others.
    record.point.failure = error.what();
    logWarning("{}, {}, {}: {}", sceneShown, loaded.shown, pointText(planned.parameters), error.what());
  }
  return record;
}

SceneRecord measureScene(gpu::Device& device, TechniqueSet& techniques, const ReportOptions& options,
                         const Scene& scene, const std::vector<const LoadedPipeline*>& pipelines,
                         const std::string& shown) {
  const Camera& camera = scene.camera(options.camera);
  SceneRecord record;
  record.file = shown;
  record.name = scene.name;
  record.hash = scene.hash.text();
  record.camera = camera.name;
  record.time = options.time;
  record.triangles = scene.triangleCount();
  std::tie(record.width, record.height) =
      options.width > 0        ? std::pair(options.width, options.height)
      : device.info().software ? reducedResolution(camera.width, camera.height, kSoftwarePixels)
                               : std::pair(camera.width, camera.height);

  ReferenceOptions truthOptions;
  truthOptions.samplesPerPixel =
      options.truthSamples > 0 ? options.truthSamples : truthSamplesFor(record.width, record.height);
  truthOptions.seed = options.seed;
  truthOptions.time = options.time;
  truthOptions.camera = options.camera;
  truthOptions.width = record.width;
  truthOptions.height = record.height;
  logInformation("{}: truth at {} x {}, {} samples per pixel", shown, record.width, record.height,
                 truthOptions.samplesPerPixel);
  Truth truth(scene, truthOptions);
  record.truthSamples = truthOptions.samplesPerPixel;
  record.truthSeconds = truth.seconds();
  record.truthAttributes = truth.layers().attributes;

  const MeasureContext context{device, techniques, scene, options, truth, record.width, record.height};
  for (const LoadedPipeline* loaded : pipelines) {
    bool defaultWorks = true;
    for (const PlannedPoint& planned :
         plannedPoints(loaded->pipeline, loaded->settings, options.openSweeps)) {
      record.points.push_back(measurePoint(context, *loaded, planned, shown, truthOptions.samplesPerPixel));
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
  return record;
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

  ReportData data;
  data.options = options;
  data.device = device.info();
  data.shaderInput = device.shaderInput() == gpu::ShaderInput::spirv ? "SPIR-V" : "GLSL made from the SPIR-V";
  data.host = hostText();
  data.date = fmt::format("{:%Y-%m-%d %H:%M:%S} UTC", fmt::gmtime(std::time(nullptr)));

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
    data.scenes.push_back(
        measureScene(device, techniques, options, scenes[i], pipelines[i], shownPath(options.scenes[i])));
    data.scenes.back().unsuited = unsuited[i];
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
