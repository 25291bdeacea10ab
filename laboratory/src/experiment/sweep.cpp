// Runs sweeps: plans the points, skips those that are stored and measures the rest.
#include "lumivox/experiment/sweep.h"

#include <fmt/format.h>

#include <map>
#include <memory>
#include <set>

#include "experiment/measurer.h"
#include "experiment/plan.h"
#include "lumivox/base/error.h"
#include "lumivox/pipeline/sweep_text.h"

namespace lumivox {

using namespace experiment;

namespace {

/// A scene with all points to measure on it, so that its reference is made once.
struct ScenePlan {
  std::unique_ptr<Measurer> measurer;
  std::vector<WantedPoint> points, missing;
};

/// All points of a sweep, by scenes in the order of first mention.
class SweepPlan {
 public:
  SweepPlan(gpu::Device& device, TechniqueSet& techniques, const SweepOptions& options, ResultsStore& store,
            const std::function<Scene(const std::filesystem::path&)>& loadScene)
      : device_(device), techniques_(techniques), options_(options), store_(store), loadScene_(loadScene) {}

  /// Adds a scene of the command line: the pipelines that are given or suit it, at the points of their own
  /// sweeps.
  void addScene(const std::filesystem::path& file, PipelineChoice& choice, SweepSummary& summary) {
    ScenePlan& plan = planOf(file);
    std::vector<std::pair<std::string, std::string>> unsuited;
    for (const LoadedPipeline* loaded : choice.forScene(plan.measurer->scene(), unsuited))
      addPoints(plan, loaded, pointsFor(*loaded, techniques_, options_.measure));
    for (const auto& [pipeline, why] : unsuited)
      summary.unsuited.push_back(fmt::format("{}, {}: {}", shownPath(file), pipeline, why));
  }

  void addText(const std::filesystem::path& file, SweepSummary& summary) {
    const SweepText text = SweepText::load(file);
    std::vector<const LoadedPipeline*> all;
    std::vector<std::pair<const SweepBlock*, std::vector<PlannedPoint>>> wanted;
    for (SweepShare& share : sweepShares(text, techniques_, summary.notes)) {
      loaded_.push_back(
          std::make_unique<LoadedPipeline>(withSettings(*share.pipeline, options_.measure.settings)));
      all.push_back(loaded_.back().get());
      if (!options_.measure.openSweeps) share.sweep.axes.clear();
      const bool progressive = isProgressive(*share.pipeline, techniques_);
      if (std::string note = withoutFrames(*share.pipeline, {share.sweep}, progressive); !note.empty())
        summary.notes.push_back(std::move(note));
      wanted.emplace_back(
          &text.sweeps[share.block],
          pointsOfSweeps(all.back()->pipeline, all.back()->settings, {share.sweep}, progressive));
    }
    requireKnownSettings(all, options_.measure.settings);
    for (std::size_t i = 0; i < wanted.size(); ++i)
      for (const std::filesystem::path& scene : wanted[i].first->scenes)
        addPoints(planOf(scene), all[i], wanted[i].second);
  }

  /// Collects the points that the store lacks; counts those it has.
  std::size_t findMissing(SweepSummary& summary) {
    std::size_t total = 0;
    for (ScenePlan& plan : plans_) {
      const std::vector<bool> held = plan.measurer->held(plan.points, options_.retryFailed);
      std::set<std::string> seen;  // several sweeps may name the same point
      for (std::size_t i = 0; i < plan.points.size(); ++i) {
        const std::string key = plan.measurer->key(plan.points[i]);
        if (!seen.insert(key).second) continue;
        summary.keys.push_back(key);
        if (held[i]) {
          ++summary.held;
          continue;
        }
        if (options_.planOnly) summary.missing.push_back(plan.measurer->text(plan.points[i]));
        plan.missing.push_back(plan.points[i]);
      }
      total += plan.missing.size();
    }
    return total;
  }

  std::vector<ScenePlan>& scenes() { return plans_; }

 private:
  ScenePlan& planOf(const std::filesystem::path& file) {
    std::error_code failure;
    const std::filesystem::path canonical = std::filesystem::weakly_canonical(file, failure);
    const auto [index, isNew] = indices_.emplace(canonical, plans_.size());
    if (isNew)
      plans_.push_back(
          {std::make_unique<Measurer>(device_, techniques_, options_.measure, store_, loadScene_(file),
                                      shownPath(file), Measurer::Images::no, costs_),
           {},
           {}});
    return plans_[index->second];
  }

  static void addPoints(ScenePlan& plan, const LoadedPipeline* loaded,
                        const std::vector<PlannedPoint>& points) {
    for (const PlannedPoint& point : points) {
      if (point.seeds.empty()) plan.points.push_back({loaded, point, {}});
      for (const std::uint64_t seed : point.seeds) plan.points.push_back({loaded, point, seed});
    }
  }

  gpu::Device& device_;
  TechniqueSet& techniques_;
  const SweepOptions& options_;
  ResultsStore& store_;
  const std::function<Scene(const std::filesystem::path&)>& loadScene_;
  std::vector<std::unique_ptr<LoadedPipeline>> loaded_;
  std::map<std::filesystem::path, std::size_t> indices_;
  std::vector<ScenePlan> plans_;
  const std::shared_ptr<Costs> costs_ = std::make_shared<Costs>();
};

}  // namespace

SweepSummary runSweep(gpu::Device& device, TechniqueSet& techniques, const SweepOptions& options,
                      ResultsStore& store,
                      const std::function<Scene(const std::filesystem::path&)>& loadScene) {
  const ReportOptions& measure = options.measure;
  if (measure.scenes.empty() && options.texts.empty()) throw Error("a sweep needs at least one scene");
  if (measure.scenes.empty() && !measure.pipelines.empty())
    throw Error("the text of a sweep names its pipelines; --pipeline is for scenes only");
  SweepSummary summary;
  PipelineChoice choice(measure, techniques);
  SweepPlan plan(device, techniques, options, store, loadScene);
  // All texts are checked before the first image is rendered.
  for (const std::filesystem::path& file : measure.scenes) plan.addScene(file, choice, summary);
  for (const std::filesystem::path& file : options.texts) plan.addText(file, summary);
  const std::size_t total = plan.findMissing(summary);

  std::size_t finished = 0;
  ScenePlan* first = nullptr;
  const auto done = [&](std::size_t measured, std::size_t byOthers) {
    summary.measured += measured;
    summary.held += byOthers;
    finished += measured + byOthers;
    if (!measure.progress) return;
    double left = first->measurer->controlSeconds(first->missing);
    for (const ScenePlan& scene : plan.scenes())
      if (!scene.missing.empty())
        left += scene.measurer->referenceSeconds() + scene.measurer->secondsLeft(scene.missing);
    measure.progress(finished, total, left);
  };
  for (ScenePlan& scene : plan.scenes()) {
    if (options.planOnly) break;
    if (first == nullptr && !scene.missing.empty()) first = &scene;
    scene.measurer->lookAt(scene.missing);
    for (const StoredRun& run : scene.measurer->measure(scene.missing, done))
      summary.failed += run.point.failure.empty() ? 0 : 1;
  }
  // The first points are timed again at the end, to learn how far repeated times differ on this machine.
  if (first != nullptr && summary.measured > 0) first->measurer->control(first->missing);
  for (const std::string& key : summary.keys)
    if (std::optional<StoredRun> stored = store.find(key)) summary.runs.push_back(std::move(*stored));
  return summary;
}

}  // namespace lumivox
