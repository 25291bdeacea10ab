#include "lumivox/experiment/needs.h"

#include <fmt/format.h>

#include "experiment/choice.h"
#include "lumivox/base/error.h"

namespace lumivox {
namespace {

using namespace experiment;

/// The given pipelines or every committed one, including those that do not suit the scene.
ReportOptions withPipelines(ReportOptions options) {
  if (!options.pipelines.empty()) return options;
  const auto folder = committedScenes(options.scenes.empty() ? std::filesystem::path()
                                                             : options.scenes.front().parent_path());
  if (folder) options.pipelines = pipelinesIn(*folder / "pipelines");
  if (options.pipelines.empty())
    throw Error(
        "no folder 'pipelines' beside the scene and no project in this folder or above; name a pipeline");
  return options;
}

NeededCell measureCell(gpu::Device& device, TechniqueSet& techniques, const ReportOptions& options,
                       const Scene& scene, const LoadedPipeline& loaded, NeededCell cell) {
  RenderOptions render;
  render.parameters = loaded.settings;
  render.seed = options.seed;
  render.camera = options.camera;
  std::tie(render.width, render.height) = measuredSize(device, scene, options);
  cell.unsuited = whyUnsuited(loaded.pipeline, techniques, SceneTraits::of(scene));
  try {
    cell.record =
        measurePruning(device, techniques, scene, loaded.pipeline, render, options.time, options.repeats);
    cell.record->scene = cell.scene;
    cell.record->pipeline = cell.pipeline;
  } catch (const DiagnosticsError&) {
    throw;  // a wrong text is wrong on every scene
  } catch (const Error& error) {
    cell.absent = error.what();
    cell.failed = true;
  }
  return cell;
}

}  // namespace

std::vector<NeededCell> measureNeeded(gpu::Device& device, TechniqueSet& techniques,
                                      const ReportOptions& options,
                                      const std::function<Scene(const std::filesystem::path&)>& loadScene,
                                      const std::function<void(std::size_t done, std::size_t total)>& done) {
  const ReportOptions asked = withPipelines(options);
  PipelineChoice choice(asked, techniques);
  std::vector<NeededCell> cells;
  for (const std::filesystem::path& file : asked.scenes) {
    std::optional<Scene> scene;
    std::string absent;
    try {
      scene.emplace(loadScene(file));
    } catch (const AbsentError& error) {
      absent = error.what();
    }
    for (const LoadedPipeline& loaded : choice.given()) {
      NeededCell cell{shownPath(file), loaded.shown, {}, absent, false, std::nullopt};
      cells.push_back(scene ? measureCell(device, techniques, asked, *scene, loaded, std::move(cell))
                            : std::move(cell));
      if (done) done(cells.size(), asked.scenes.size() * asked.pipelines.size());
    }
  }
  return cells;
}

}  // namespace lumivox
