// Sweeps: plan, leave out what is stored, measure the rest.
#include "lumivox/report/sweep.h"

#include <fmt/format.h>

#include <chrono>

#include "lumivox/base/error.h"
#include "report/measurer.h"
#include "report/plan.h"

namespace lumivox {

using namespace report;

SweepSummary runSweep(gpu::Device& device, TechniqueSet& techniques, const SweepOptions& options,
                      ResultsStore& store,
                      const std::function<Scene(const std::filesystem::path&)>& loadScene) {
  const ReportOptions& measure = options.measure;
  if (measure.scenes.empty()) throw Error("a sweep needs at least one scene");
  SweepSummary summary;
  PipelineChoice choice(measure, techniques);
  struct ScenePlan {
    Measurer measurer;
    std::vector<WantedPoint> missing;
  };
  // All texts are read before the first picture is rendered.
  std::vector<ScenePlan> plans;
  std::size_t total = 0;
  for (const std::filesystem::path& file : measure.scenes) {
    const std::string shown = shownPath(file);
    ScenePlan plan{Measurer(device, techniques, measure, store, loadScene(file), shown), {}};
    std::vector<std::pair<std::string, std::string>> unsuited;
    std::vector<WantedPoint> points;
    for (const LoadedPipeline* loaded : choice.forScene(plan.measurer.scene(), unsuited))
      for (PlannedPoint& point : plannedPoints(loaded->pipeline, loaded->settings, measure.openSweeps))
        points.push_back({loaded, std::move(point)});
    const std::vector<bool> held = plan.measurer.held(points, options.retryFailed);
    for (std::size_t i = 0; i < points.size(); ++i) {
      summary.keys.push_back(plan.measurer.key(points[i]));
      if (held[i]) {
        ++summary.held;
      } else {
        if (options.planOnly) summary.missing.push_back(plan.measurer.text(points[i]));
        plan.missing.push_back(points[i]);
      }
    }
    for (const auto& [pipeline, why] : unsuited)
      summary.unsuited.push_back(fmt::format("{}, {}: {}", shown, pipeline, why));
    total += plan.missing.size();
    plans.push_back(std::move(plan));
  }

  const auto start = std::chrono::steady_clock::now();
  const auto done = [&](std::size_t points) {
    summary.measured += points;
    if (!options.progress) return;
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const auto left = static_cast<double>(total - summary.measured);
    options.progress(summary.measured, total, seconds / static_cast<double>(summary.measured) * left);
  };
  for (ScenePlan& plan : plans) {
    if (options.planOnly) break;
    for (const StoredRun& run : plan.measurer.measure(plan.missing, done))
      summary.failed += run.point.failure.empty() ? 0 : 1;
  }
  for (const std::string& key : summary.keys)
    if (std::optional<StoredRun> stored = store.find(key)) summary.runs.push_back(std::move(*stored));
  return summary;
}

}  // namespace lumivox
