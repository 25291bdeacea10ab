#include "experiment/measurer.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "base/process.h"
#include "experiment/plan.h"
#include "lumivox/base/error.h"
#include "lumivox/base/log.h"
#include "lumivox/results/text.h"

namespace lumivox::experiment {
namespace {

/// Points whose timed frames take turns. Each keeps its resources while it waits, and an interruption loses
/// the batch.
constexpr std::size_t kBatch = 6;
/// Between two looks at what other processes do.
constexpr std::chrono::milliseconds kPause{200};

/// Does something at the end of a scope, whatever ended it.
template <class Work>
class Finally {
 public:
  explicit Finally(Work work) : work_(std::move(work)) {}
  ~Finally() {
    try {
      work_();
    } catch (const std::exception& error) {
      logWarning("{}", error.what());
    }
  }
  Finally(const Finally&) = delete;
  Finally& operator=(const Finally&) = delete;

 private:
  Work work_;
};

std::string runText(const StoredRun& run) {
  const std::string seed =
      run.identity.seeds == 1 ? fmt::format(", seed {}", run.identity.seed) : std::string();
  return fmt::format("{}, {}: {}{}", run.point.scene, run.point.pipeline, pointText(run.point.parameters),
                     seed);
}

/// One point that does not fit into memory, say, must not cost the others.
template <class Work>
void guarded(StoredRun& run, const Work& work) {
  if (!run.point.failure.empty()) return;
  if (const std::string why = whyFailed(work); !why.empty()) {
    fail(run.point, why);
    logWarning("{}: {}", runText(run), why);
  }
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

Measurer::Batch Measurer::claimed(std::vector<WantedPoint>& pending, std::size_t& byOthers) {
  Batch batch;
  std::vector<WantedPoint> left;
  for (const WantedPoint& point : pending) {
    StoredRun run = open(point);
    const std::string key = run.identity.key();
    // Failed points are among those that are asked for, where they are to be tried again.
    const auto isThere = [&] {
      const std::optional<StoredRun> stored = store_.find(key);
      return stored && stored->point.failure.empty();
    };
    if (isThere()) {
      ++byOthers;
    } else if (batch.size() == kBatch || !store_.claim({key}).front()) {
      left.push_back(point);
    } else if (isThere()) {  // since the look before the claim
      store_.release({key});
      ++byOthers;
    } else {
      batch.emplace_back(point.loaded, std::move(run));
    }
  }
  pending = std::move(left);
  return batch;
}

std::vector<StoredRun> Measurer::measure(const std::vector<WantedPoint>& points,
                                         const std::function<void(std::size_t, std::size_t)>& done) {
  std::vector<WantedPoint> pending = points;
  std::vector<std::string> own;
  // A wrong text ends the batch; others may then try.
  const Finally release([&] { store_.release(own); });
  bool told = false;
  while (!pending.empty()) {
    std::size_t byOthers = 0;
    Batch batch = claimed(pending, byOthers);
    own.clear();
    for (const auto& entry : batch) own.push_back(entry.second.identity.key());
    if (batch.empty() && byOthers == 0) {
      if (!told) logInformation("{}", waitingText(pending));
      told = true;
      std::this_thread::sleep_for(kPause);
      continue;
    }
    if (!batch.empty()) measureBatch(batch);
    for (auto& [loaded, run] : batch) {
      run.created = dateText();
      store_.add(run);
    }
    if (done) done(batch.size(), byOthers);
  }
  std::vector<StoredRun> result;
  for (const WantedPoint& point : points) result.push_back(store_.find(key(point)).value());
  return result;
}

std::string Measurer::waitingText(const std::vector<WantedPoint>& pending) const {
  for (const WantedPoint& point : pending)
    if (const std::optional<RunClaim> claim = store_.claimedByOther(key(point)))
      return fmt::format("waiting for {} points, the first of which process {} measures{}", pending.size(),
                         claim->process, claim->command.empty() ? "" : ": " + claim->command);
  return fmt::format("waiting for {} points that others measure", pending.size());
}

void Measurer::control(const std::vector<WantedPoint>& points) {
  Batch batch;
  for (const WantedPoint& point : points) {
    if (batch.size() == kBatch) break;
    const std::optional<StoredRun> stored = store_.find(key(point));
    if (stored && stored->point.failure.empty()) batch.emplace_back(point.loaded, open(point));
  }
  timeTogether(batch);
  for (const auto& [loaded, run] : batch)
    if (run.point.failure.empty())
      store_.addControl(run.identity.key(), run.point.frameMs, run.point.nextFrameMs);
}

TimeFloor Measurer::floor() const {
  const DeviceIdentity here = identityOf(device_);
  RunIdentity where;
  where.device = here.device;
  where.driver = here.driver;
  where.shaderInput = here.shaderInput;
  where.host = here.host;
  return timeFloorOf(store_.controls(where));
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

void Measurer::measureBatch(Batch& batch) {
  std::vector<std::string> keys;
  for (const auto& entry : batch) keys.push_back(entry.second.identity.key());
  for (auto& entry : batch) {
    const MachineLock working(MachineLock::For::work);
    if (!truth_) truth_.emplace(scene_, truthOptions_);
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
    store_.claim(keys);  // still at it
  }
  timeTogether(batch);
}

void Measurer::timeTogether(Batch& batch) {
  struct Timed {
    StoredRun& run;
    TimedPoint point;
  };
  const MachineLock alone(MachineLock::For::timing);
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
  for (Timed& one : timed)
    if (one.run.point.failure.empty()) one.point.finish();
}

}  // namespace lumivox::experiment
