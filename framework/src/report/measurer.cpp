#include "report/measurer.h"

#include <fmt/format.h>

#include <algorithm>

#include "lumivox/base/error.h"
#include "lumivox/base/log.h"
#include "report/plan.h"

namespace lumivox::report {
namespace {

/// Points whose timed frames take turns. Each keeps its resources while it waits, and an interruption loses
/// the batch.
constexpr std::size_t kBatch = 6;

std::string runText(const StoredRun& run) {
  const std::string seed =
      run.identity.seeds == 1 ? fmt::format(", seed {}", run.identity.seed) : std::string();
  return fmt::format("{}, {}: {}{}", run.point.scene, run.point.pipeline, pointText(run.point.parameters),
                     seed);
}

}  // namespace

Measurer::Measurer(gpu::Device& device, TechniqueSet& techniques, const ReportOptions& options,
                   ResultsStore& store, Scene scene, std::string sceneShown)
    : device_(device),
      techniques_(techniques),
      options_(options),
      store_(store),
      scene_(std::move(scene)),
      sceneShown_(std::move(sceneShown)) {
  std::tie(width_, height_) = measuredSize(device_, scene_, options_);
  truthOptions_ = truthOptionsOf(options_, width_, height_);
}

StoredRun Measurer::open(const WantedPoint& point) const {
  ReportOptions options = options_;
  if (point.seed) {
    options.seed = *point.seed;
    options.seeds = 1;
  }
  return storedRunOf(device_, techniques_, scene_, *point.loaded, point.point, options, width_, height_,
                     truthOptions_.samplesPerPixel, sceneShown_);
}

ReportOptions Measurer::optionsOf(const RunIdentity& identity) const {
  ReportOptions options = options_;
  options.seed = identity.seed;
  options.seeds = identity.seeds;
  return options;
}

std::string Measurer::key(const WantedPoint& point) const {
  return open(point).identity.key();
}

std::string Measurer::text(const WantedPoint& point) const {
  return runText(open(point));
}

std::vector<bool> Measurer::held(const std::vector<WantedPoint>& points, bool retryFailed) const {
  std::vector<bool> result;
  for (const WantedPoint& point : points) {
    const std::optional<StoredRun> stored = store_.find(key(point));
    result.push_back(stored && (stored->point.failure.empty() || !retryFailed));
  }
  return result;
}

std::vector<StoredRun> Measurer::measure(const std::vector<WantedPoint>& points,
                                         const std::function<void(std::size_t)>& done) {
  if (points.empty()) return {};
  if (!truth_) truth_.emplace(scene_, truthOptions_);
  std::vector<StoredRun> result;
  for (std::size_t first = 0; first < points.size(); first += kBatch) {
    std::vector<std::pair<const LoadedPipeline*, StoredRun>> batch;
    for (std::size_t i = first; i < std::min(points.size(), first + kBatch); ++i)
      batch.emplace_back(points[i].loaded, open(points[i]));
    measureBatch(batch);
    for (auto& [loaded, run] : batch) {
      run.created = dateText();
      store_.add(run);
      result.push_back(store_.find(run.identity.key()).value());
    }
    if (done) done(batch.size());
  }
  return result;
}

std::vector<StoredRun> Measurer::fetch(const std::vector<WantedPoint>& points) {
  const std::vector<bool> there = held(points, false);
  std::vector<WantedPoint> missing;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!there[i]) missing.push_back(points[i]);
  measure(missing);
  std::vector<StoredRun> result;
  for (const WantedPoint& point : points) result.push_back(store_.find(key(point)).value());
  return result;
}

void Measurer::measureBatch(std::vector<std::pair<const LoadedPipeline*, StoredRun>>& batch) {
  // One point that does not fit into memory, say, must not cost the others.
  const auto guarded = [](StoredRun& run, const auto& work) {
    if (!run.point.failure.empty()) return;
    try {
      work();
    } catch (const DiagnosticsError&) {
      throw;  // a wrong text is wrong at every point
    } catch (const Error& error) {
      run.point.failure = error.what();
      logWarning("{}: {}", runText(run), error.what());
    }
  };
  for (auto& entry : batch) {
    logInformation("{}", runText(entry.second));
    guarded(entry.second, [&] {
      PointRecord record;
      record.point = entry.second.point;
      const ReportOptions options = optionsOf(entry.second.identity);
      const MeasureContext context{{device_, techniques_, scene_, options, width_, height_}, *truth_};
      measureErrors(context, entry.first->pipeline, record);
      measureFlicker(context, entry.first->pipeline, record);
      countWork(context, entry.first->pipeline, {}, record.point);
      entry.second.point = std::move(record.point);
    });
  }
  struct Timed {
    StoredRun& run;
    TimedPoint point;
  };
  std::vector<Timed> timed;
  for (auto& entry : batch)
    guarded(entry.second, [&] {
      const ReportOptions options = optionsOf(entry.second.identity);
      timed.push_back({entry.second, TimedPoint({device_, techniques_, scene_, options, width_, height_},
                                                entry.first->pipeline, entry.second.point)});
    });
  const int repeats = std::max(1, options_.repeats);
  for (int repeat = 0; repeat < repeats; ++repeat)
    for (Timed& one : timed) guarded(one.run, [&] { one.point.timeFrame(); });
  for (int repeat = 0; repeat < repeats; ++repeat)
    for (Timed& one : timed) guarded(one.run, [&] { one.point.timeNextFrame(); });
  for (Timed& one : timed) one.point.finish();
}

}  // namespace lumivox::report
