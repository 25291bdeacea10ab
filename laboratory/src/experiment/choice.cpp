#include "experiment/choice.h"

#include <fmt/format.h>

#include <algorithm>

#include "experiment/measure.h"
#include "experiment/plan.h"
#include "lumivox/base/error.h"
#include "lumivox/base/log.h"
#include "lumivox/results/text.h"

namespace lumivox::experiment {
namespace {

/// Longest side of the images on a software rasteriser. A frame at the camera's resolution takes too long
/// there to be repeated.
constexpr int kSoftwarePixels = 128;

std::vector<LoadedPipeline> loadAll(const std::vector<std::filesystem::path>& files,
                                    const std::vector<std::string>& settings) {
  std::vector<LoadedPipeline> all;
  for (const std::filesystem::path& file : files) all.push_back(withSettings(Pipeline::load(file), settings));
  std::vector<const LoadedPipeline*> pointers;
  for (const LoadedPipeline& one : all) pointers.push_back(&one);
  requireKnownSettings(pointers, settings);
  return all;
}

}  // namespace

LoadedPipeline withSettings(Pipeline pipeline, const std::vector<std::string>& settings) {
  LoadedPipeline loaded{std::move(pipeline), {}, {}};
  loaded.shown = shownPath(loaded.pipeline.file);
  loaded.settings = loaded.pipeline.settings(settingsFor(loaded.pipeline, settings));
  return loaded;
}

void requireKnownSettings(const std::vector<const LoadedPipeline*>& pipelines,
                          const std::vector<std::string>& settings) {
  for (const std::string& setting : settings) {
    const auto knows = [&](const LoadedPipeline* one) {
      return !settingsFor(one->pipeline, {setting}).empty();
    };
    if (!pipelines.empty() && std::none_of(pipelines.begin(), pipelines.end(), knows))
      pipelines.front()->pipeline.settings({setting});
  }
}

PipelineChoice::PipelineChoice(const ReportOptions& options, TechniqueSet& techniques)
    : options_(options), techniques_(techniques) {
  given_ = loadAll(options.pipelines, options.settings);
  for (const LoadedPipeline& one : given_) checkPipeline(one.pipeline, techniques);
}

std::vector<const LoadedPipeline*> PipelineChoice::forScene(
    const Scene& scene, std::vector<std::pair<std::string, std::string>>& unsuited) {
  std::vector<const LoadedPipeline*> chosen;
  if (!options_.pipelines.empty()) {
    for (const LoadedPipeline& one : given_) chosen.push_back(&one);
    return chosen;
  }
  const auto folder = committedScenes(scene.file.parent_path());
  if (!folder)
    throw Error(fmt::format(
        "{}: no folder 'pipelines' beside the scene and no project in this folder or above; name one with --pipeline",
        scene.file.string()));
  std::vector<LoadedPipeline>& all = committed_[*folder];
  if (all.empty()) all = loadAll(pipelinesIn(*folder / "pipelines"), options_.settings);
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

std::string PipelineChoice::missingTechnique(const Pipeline& pipeline) {
  for (const std::string& name : pipeline.techniques()) {
    if (techniques_.technique(name) != nullptr) continue;
    for (const SkippedTechnique& skipped : techniques_.skipped())
      if (skipped.library.stem() == "lib" + name || skipped.library.stem() == name)
        return fmt::format("its technique '{}' was skipped: {}", name, skipped.reason);
    return fmt::format("its technique '{}' is not among the technique libraries", name);
  }
  return {};
}

std::vector<PlannedPoint> pointsFor(const LoadedPipeline& loaded, TechniqueSource& techniques,
                                    const ReportOptions& options) {
  const bool progressive = isProgressive(loaded.pipeline, techniques);
  const std::string note = withoutFrames(loaded.pipeline, loaded.pipeline.sweeps, progressive);
  if (options.openSweeps && !note.empty()) logInformation("{}: {}", loaded.shown, note);
  return plannedPoints(loaded.pipeline, loaded.settings, options.openSweeps, progressive, options.frames);
}

std::pair<int, int> measuredSize(const gpu::Device& device, const Scene& scene,
                                 const ReportOptions& options) {
  if (options.width > 0) return {options.width, options.height};
  const Camera& camera = scene.camera(options.camera);
  if (device.info().software) return reducedResolution(camera.width, camera.height, kSoftwarePixels);
  return {camera.width, camera.height};
}

ReferenceOptions referenceOptionsOf(const ReportOptions& options, int width, int height) {
  ReferenceOptions reference;
  reference.samplesPerPixel =
      options.referenceSamples > 0 ? options.referenceSamples : referenceSamplesFor(width, height);
  // Only the techniques get the seed: all of them are judged against one reference.
  reference.time = options.time;
  reference.camera = options.camera;
  reference.width = width;
  reference.height = height;
  return reference;
}

namespace {

/// Empty for the usual display.
std::string displayText(const ReportOptions& options) {
  std::string text;
  if (options.exposure) text = fmt::format("exposure {}", *options.exposure);
  if (options.tone != kShownTone)
    text += (text.empty() ? "tone " : ", tone ") + std::string(name(options.tone));
  return text;
}

}  // namespace

StoredRun storedRunOf(gpu::Device& device, TechniqueSource& techniques, const Scene& scene,
                      const LoadedPipeline& loaded, const PlannedPoint& point, const ReportOptions& options,
                      int width, int height, int referenceSamples, const std::string& sceneShown) {
  StoredRun run;
  RunIdentity& identity = run.identity;
  identity.sceneHash = scene.hash.text();
  identity.pipelineHash = loaded.pipeline.hash.text();
  for (const std::string& name : loaded.pipeline.techniques())
    if (const Technique* technique = techniques.technique(name))
      identity.techniques[name] = technique->hash.text() + "+" + technique->shaders.hash.text();
  identity.framework = frameworkHash();
  for (const auto& [name, value] : point.parameters) identity.parameters[name] = value.text();
  identity.camera = scene.camera(options.camera).name;
  identity.time = options.time;
  identity.width = width;
  identity.height = height;
  identity.seed = options.seed;
  identity.seeds = options.seeds;
  identity.repeats = options.repeats;
  identity.subpixels = options.subpixels;
  identity.referenceSamples = referenceSamples;
  identity.flickerPairs = flickers(scene, options) ? options.flickerPairs : 0;
  identity.display = displayText(options);
  const DeviceIdentity where = identityOf(device);
  identity.device = where.device;
  identity.driver = where.driver;
  identity.shaderInput = where.shaderInput;
  identity.host = where.host;
  run.version = LUMIVOX_VERSION;
  run.sceneName = scene.name;
  run.pipelineName = loaded.pipeline.name;
  run.isDefault = point.isDefault;
  run.point.scene = sceneShown;
  run.point.pipeline = loaded.shown;
  run.point.sweep = point.sweep;
  run.point.parameters = point.parameters;
  run.point.command =
      repeatingCommand(options, sceneShown, loaded.shown, point.parameters, width, height, referenceSamples);
  return run;
}

}  // namespace lumivox::experiment
