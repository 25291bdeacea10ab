// Runs sweeps: plans the points, skips those that are stored and measures the rest.
#include "lumivox/experiment/sweep.h"

#include <fmt/format.h>

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <unordered_set>

#include "experiment/measurer.h"
#include "experiment/plan.h"
#include "lumivox/base/error.h"
#include "lumivox/base/hash.h"
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

  /// Adds what a scene and the texts of the options name.
  void addAll(PipelineChoice& choice, SweepSummary& summary) {
    for (const std::filesystem::path& file : options_.measure.scenes) addScene(file, choice, summary);
    for (const std::filesystem::path& file : options_.texts) addText(file, summary);
    for (ScenePlan& plan : plans_) {
      std::unordered_set<std::string> seen;  // several sweeps may name the same point
      std::erase_if(plan.points, [&](const WantedPoint& point) { return !seen.insert(idOf(point)).second; });
    }
  }

  /// Of everything that positions in the plan mean.
  std::string hash() const {
    Hasher hasher;
    for (const ScenePlan& plan : plans_) {
      hasher.add(plan.measurer->scene().hash.text());
      for (const WantedPoint& point : plan.points)
        hasher.add(point.loaded->pipeline.hash.text()).add(idOf(point));
    }
    return hasher.finish().text();
  }

  std::size_t points() const {
    std::size_t count = 0;
    for (const ScenePlan& plan : plans_) count += plan.points.size();
    return count;
  }

  /// Keeps the points of the wanted share.
  void keepShare() {
    if (options_.shard.isWhole() && options_.points.empty()) return;
    std::vector<bool> kept(points(), false);
    for (const std::size_t position : positionsOf(options_.shard, options_.points, hash(), kept.size()))
      kept[position] = true;
    std::size_t position = 0;
    for (ScenePlan& plan : plans_)
      std::erase_if(plan.points, [&](const WantedPoint&) { return !kept[position++]; });
  }

  /// Collects the points that the store lacks; counts those it has.
  std::size_t findMissing(SweepSummary& summary, const ResultsStore* into) {
    std::size_t total = 0;
    for (ScenePlan& plan : plans_) {
      std::set<std::string> seen;  // scenes may be equal
      for (const WantedPoint& point : plan.points) {
        const StoredRun run = plan.measurer->open(point);
        const std::string key = run.identity.key();
        if (!seen.insert(key).second) continue;
        summary.keys.push_back(key);
        std::optional<bool> succeeded = store_.succeeded(key);
        if (!succeeded && into != nullptr) succeeded = into->succeeded(key);
        if (succeeded && (*succeeded || !options_.retryFailed)) {
          ++summary.held;
          continue;
        }
        if (options_.planOnly) summary.missing.push_back(plan.measurer->text(point));
        plan.missing.push_back(point);
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
      plans_.push_back({std::make_unique<Measurer>(
                            device_, techniques_, options_.measure, store_, loadScene_(file), shownPath(file),
                            options_.forReport ? Measurer::Images::kept : Measurer::Images::no, costs_),
                        {},
                        {}});
    return plans_[index->second];
  }

  void addPoints(ScenePlan& plan, const LoadedPipeline* loaded,
                 const std::vector<PlannedPoint>& points) const {
    for (const PlannedPoint& point : points) {
      if (point.seeds.empty() || options_.forReport) plan.points.push_back({loaded, point, {}});
      if (options_.forReport) continue;
      // Each seed's point does without the list of all.
      PlannedPoint one = point;
      one.seeds.clear();
      for (const std::uint64_t seed : point.seeds) plan.points.push_back({loaded, one, seed});
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
  plan.addAll(choice, summary);
  plan.keepShare();
  std::optional<ResultsStore> into;
  if (!options.into.empty()) into.emplace(options.into);
  // A share that goes on elsewhere must not wait for what it had claimed in its own store.
  if (!options.shard.isWhole() && !options.planOnly) store.releaseElsewhere();
  const std::size_t total = plan.findMissing(summary, into ? &*into : nullptr);

  const bool isShare = !options.shard.isWhole() || into || !options.points.empty();
  std::size_t finished = 0;
  ScenePlan* first = nullptr;
  const auto done = [&](std::size_t measured, std::size_t byOthers) {
    summary.measured += measured;
    summary.held += byOthers;
    finished += measured + byOthers;
    if (!measure.progress) return;
    if (isShare) return measure.progress(finished, total, kUnknownSeconds);
    double left = first->measurer->controlSeconds(first->missing);
    for (const ScenePlan& scene : plan.scenes())
      if (!scene.missing.empty())
        left += scene.measurer->referenceSeconds() + scene.measurer->secondsLeft(scene.missing);
    measure.progress(finished, total, left);
  };
  for (ScenePlan& scene : plan.scenes()) {
    if (options.planOnly) break;
    if (first == nullptr && !scene.missing.empty()) first = &scene;
    if (isShare)
      scene.measurer->measureShare(into ? &*into : nullptr);
    else
      scene.measurer->lookAt(scene.missing);
    for (const StoredRun& run : scene.measurer->measure(scene.missing, done))
      summary.failed += run.point.failure.empty() ? 0 : 1;
    summary.leftToOthers += scene.measurer->leftToOthers();
  }
  // The first points are timed again at the end, to learn how far repeated times differ on this machine. Of
  // the shares one does so for all.
  if (first != nullptr && summary.measured > 0 && options.shard.index == 1)
    first->measurer->control(first->missing, isShare ? 1 : Measurer::kBatch);
  for (const std::string& key : summary.keys)
    if (std::optional<StoredRun> stored = store.find(key)) summary.runs.push_back(std::move(*stored));
  return summary;
}

namespace {

/// What a store knows of times: of a point's pipeline on its scene, on any scene, and of all.
class KnownTimes {
 public:
  void add(const std::string& scene, const std::string& pipeline, double seconds) {
    if (!(seconds > 0.0)) return;
    for (const std::string& subject : {scene + "|" + pipeline, "|" + pipeline}) {
      Sum& sum = sums_[subject];
      sum.seconds += seconds;
      sum.points += 1.0;
    }
  }
  /// s; 0: unknown.
  double of(const std::string& scene, const std::string& pipeline) const {
    for (const std::string& subject : {scene + "|" + pipeline, "|" + pipeline})
      if (const auto found = sums_.find(subject); found != sums_.end())
        return found->second.seconds / found->second.points;
    return 0.0;
  }

 private:
  struct Sum {
    double seconds = 0.0, points = 0.0;
  };
  std::map<std::string, Sum> sums_;
};

}  // namespace

SharedPlan planSweep(gpu::Device& device, TechniqueSet& techniques, const SweepOptions& options,
                     const std::function<Scene(const std::filesystem::path&)>& loadScene, std::size_t tasks,
                     double taskSeconds) {
  ResultsStore into(options.into);
  SweepSummary summary;
  PipelineChoice choice(options.measure, techniques);
  SweepPlan plan(device, techniques, options, into, loadScene);
  plan.addAll(choice, summary);
  std::unordered_set<std::string> held;
  KnownTimes times;
  into.forEachMeasured([&](const RunIdentity& identity, const std::string& scene, const std::string& pipeline,
                           double seconds) {
    held.insert(identity.anywhere());
    times.add(scene, pipeline, seconds);
  });
  std::vector<std::size_t> missing;
  std::vector<double> costs;
  std::size_t position = 0;
  for (const ScenePlan& scene : plan.scenes())
    for (const WantedPoint& point : scene.points) {
      const StoredRun run = scene.measurer->open(point);
      if (held.count(run.identity.anywhere()) == 0) {
        missing.push_back(position);
        costs.push_back(times.of(run.point.scene, run.point.pipeline));
      }
      ++position;
    }
  return sharedPlan(plan.hash(), position, missing, costs, tasks, taskSeconds);
}

bool holdsOtherVersions(const ResultsStore& store, TechniqueSource& techniques) {
  for (const auto& [what, versions] : store.versions()) {
    constexpr std::string_view kTechnique = "technique ";
    std::string here = lumivoxVersion();
    if (what.rfind(kTechnique, 0) == 0) {
      const Technique* technique = techniques.technique(what.substr(kTechnique.size()));
      if (technique == nullptr) continue;
      here = technique->hash.text() + "+" + technique->shaders.hash.text();
    }
    if (versions != std::set<std::string>{here}) return true;
  }
  return false;
}

}  // namespace lumivox
