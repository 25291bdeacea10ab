#include "experiment/measurer.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <set>
#include <thread>

#include "base/process.h"
#include "experiment/plan.h"
#include "experiment/turns.h"
#include "lumivox/base/error.h"
#include "lumivox/base/log.h"
#include "lumivox/results/text.h"
#include "reference/kept.h"

namespace lumivox::experiment {
namespace {

/// Pause between two looks at the work of other processes.
constexpr std::chrono::milliseconds kPause{200};

/// Runs some work at the end of a scope, however it ends.
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

std::vector<StoredImage> storedImages(const std::vector<OutputImages>& outputs) {
  std::vector<StoredImage> stored;
  for (const OutputImages& one : outputs) {
    stored.push_back({one.output, one.component, {}, 0.0, one.image});
    for (const OutputImages::Against& map : one.against)
      stored.push_back({one.output, one.component, map.reference, map.flip, map.flipMap});
  }
  return stored;
}

/// Kinds of work in a point's costs.
const std::string kErrorsWork = "errors", kTimesWork = "times", kReferenceWork = "reference";
/// A whole point of a pipeline, on any scene.
const std::string kPointWork = "point";

/// A point that does not fit into memory, say, must not cost the others.
void failed(StoredRun& run, const std::string& why) {
  fail(run.point, why);
  logWarning("{}: {}", runText(run), why);
}

}  // namespace

std::string idOf(const WantedPoint& point) {
  return fmt::format("{}|{}|{}", point.loaded->shown, pointText(point.point.parameters),
                     point.seed ? std::to_string(*point.seed) : "");
}

Measurer::Measurer(gpu::Device& device, TechniqueSet& techniques, const ReportOptions& options,
                   ResultsStore& store, Scene scene, std::string sceneShown, Images images,
                   std::shared_ptr<Costs> costs)
    : device_(device),
      techniques_(techniques),
      options_(options),
      store_(store),
      scene_(std::move(scene)),
      sceneShown_(std::move(sceneShown)),
      images_(images),
      costs_(std::move(costs)) {
  std::tie(width_, height_) = measuredSize(device_, scene_, options_);
  referenceOptions_ = referenceOptionsOf(options_, width_, height_);
  noteProgress();
}

void nameAs(ReportPoint& point, const ReportPoint& here) {
  point.scene = here.scene;
  point.pipeline = here.pipeline;
  point.sweep = here.sweep;
  point.parameters = here.parameters;
  point.command = here.command;
}

void Measurer::noteProgress() {
  const ResultsStore::Count count = store_.count();
  const std::string untimed =
      count.untimed == 0 ? std::string() : fmt::format(", and {} more but for their times", count.untimed);
  const std::string kept = count.runs + count.untimed == 0
                               ? std::string("interrupted before the first point was measured")
                               : fmt::format("interrupted: {} keeps {} point{}{}", store_.file().string(),
                                             count.runs, count.runs == 1 ? "" : "s", untimed);
  note_.say(options_.commandLine.empty() ? kept : kept + "; to go on: " + options_.commandLine);
}

StoredRun Measurer::open(const WantedPoint& point) const {
  ReportOptions options = options_;
  if (point.seed) {
    options.seed = *point.seed;
    options.seeds = 1;
  }
  return storedRunOf(device_, techniques_, scene_, *point.loaded, point.point, options, width_, height_,
                     referenceOptions_.samplesPerPixel, sceneShown_);
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
    const std::optional<bool> succeeded = store_.succeeded(key(point));
    result.push_back(succeeded && (*succeeded || !retryFailed));
  }
  return result;
}

void Measurer::measureShare(ResultsStore* into) {
  into_ = into;
  estimates_ = false;
}

Measurer::Batch Measurer::claimed(std::vector<WantedPoint>& pending, std::size_t& byOthers) {
  Batch batch;
  std::vector<WantedPoint> left;
  for (const WantedPoint& point : pending) {
    StoredRun run = open(point);
    const std::string key = run.identity.key();
    // A failed point counts as missing where it is to be retried.
    const auto isThere = [&] {
      return store_.succeeded(key).value_or(false) ||
             (into_ != nullptr && into_->succeeded(key).value_or(false));
    };
    if (isThere()) {
      done_.insert(idOf(point));
      ++byOthers;
    } else if (batch.size() < kBatch && into_ != nullptr && !into_->claimFor(store_.file(), {key}).front()) {
      // It comes with the store of another share.
      ++leftToOthers_;
      done_.insert(idOf(point));
      ++byOthers;
    } else if (batch.size() == kBatch || !store_.claim({key}).front()) {
      left.push_back(point);
    } else if (isThere()) {  // stored since the look before the claim
      store_.release({key});
      done_.insert(idOf(point));
      ++byOthers;
    } else {
      batch.push_back({point, std::move(run)});
    }
  }
  pending = std::move(left);
  return batch;
}

std::vector<StoredRun> Measurer::measure(const std::vector<WantedPoint>& points,
                                         const std::function<void(std::size_t, std::size_t)>& done) {
  std::vector<WantedPoint> pending = points;
  std::vector<std::string> own;
  // A wrong text ends the batch; other processes may then try.
  const Finally release([&] {
    store_.release(own);
    if (into_ != nullptr) into_->releaseFor(store_.file(), own);
  });
  bool told = false;
  while (!pending.empty()) {
    std::size_t byOthers = 0;
    Batch batch = claimed(pending, byOthers);
    own.clear();
    for (const Entry& entry : batch) own.push_back(entry.run.identity.key());
    if (batch.empty() && byOthers == 0) {
      if (!told) logInformation("{}", waitingText(pending));
      told = true;
      std::this_thread::sleep_for(kPause);
      continue;
    }
    if (!batch.empty()) {
      makeReference(points);
      measureBatch(batch, done);
    }
    for (Entry& entry : batch) {
      entry.run.created = dateText();
      store_.add(entry.run, entry.images);
      done_.insert(idOf(entry.wanted));
    }
    if (into_ != nullptr && !own.empty()) into_->deliver(store_.file(), own);
    underWay_.clear();
    noteProgress();
    if (done) done(batch.empty() ? 0 : 1, byOthers);
  }
  std::vector<StoredRun> result;
  for (const WantedPoint& point : points)
    if (std::optional<StoredRun> stored = store_.find(key(point))) result.push_back(*std::move(stored));
  return result;
}

std::string Measurer::waitingText(const std::vector<WantedPoint>& pending) const {
  for (const WantedPoint& point : pending)
    if (const std::optional<RunClaim> claim = store_.claimedByOther(key(point))) {
      const std::string before = fmt::format("waiting for {} point{}, the first measured by ", pending.size(),
                                             pending.size() == 1 ? "" : "s");
      return before + processText(claim->process, claim->command, before.size());
    }
  return fmt::format("waiting for {} point{} that other processes measure", pending.size(),
                     pending.size() == 1 ? "" : "s");
}

void Measurer::control(const std::vector<WantedPoint>& points, std::size_t most) {
  Batch batch;
  for (const WantedPoint& point : points) {
    if (batch.size() == most) break;
    const std::optional<StoredRun> stored = store_.find(key(point));
    if (stored && stored->point.failure.empty()) batch.push_back({point, open(point)});
  }
  timeTogether(batch);
  for (const Entry& entry : batch)
    if (entry.run.point.failure.empty())
      store_.addControl(entry.run.identity.key(), entry.run.point.frameMs, entry.run.point.nextFrameMs);
}

TimeFloor Measurer::floor(const ResultsStore& store) const {
  const DeviceIdentity here = identityOf(device_);
  RunIdentity where;
  where.device = here.device;
  where.driver = here.driver;
  where.shaderInput = here.shaderInput;
  where.host = here.host;
  return timeFloorOf(store.controls(where));
}

std::vector<StoredRun> Measurer::fetch(const std::vector<WantedPoint>& points,
                                       const std::function<void(std::size_t, std::size_t)>& done) {
  const std::vector<bool> there = held(points, false);
  std::vector<WantedPoint> missing;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!there[i]) missing.push_back(points[i]);
  measure(missing, done);
  std::vector<StoredRun> result;
  for (const WantedPoint& point : points) result.push_back(store_.find(key(point)).value());
  return result;
}

void Measurer::makeReference(const std::vector<WantedPoint>& points) {
  if (reference_) return;
  const MachineLock working(MachineLock::For::work);
  std::set<int> layers;
  std::set<const LoadedPipeline*> seen;
  for (const WantedPoint& point : points) {
    if (!seen.insert(point.loaded).second) continue;
    RenderOptions options;
    options.parameters = point.point.parameters;
    options.parameters.erase(kAccumulatedFrames);
    options.camera = options_.camera;
    options.width = width_;
    options.height = height_;
    // A failing pipeline is reported when it is measured.
    whyFailed([&] {
      const PipelineExecutor executor(device_, techniques_, scene_, point.loaded->pipeline, options);
      for (const auto& [output, bounces] : bouncesOf(executor))
        if (bounces > 1) layers.insert(bounces);
    });
  }
  ReferenceOptions options = referenceOptions_;
  options.bounceLayers.assign(layers.begin(), layers.end());
  const bool isKept = reference::isKept(scene_, options);
  reference_.emplace(scene_, options, options_.exposure);
  if (!isKept) costs_->add(sceneShown_, kReferenceWork, referenceWeight(), reference_->seconds());
}

double Measurer::referenceWeight() const {
  return static_cast<double>(width_) * height_ * referenceOptions_.samplesPerPixel;
}

double Measurer::referenceSeconds() const {
  if (reference_) return 0.0;
  return costs_->expected(sceneShown_, kReferenceWork, referenceWeight()).value_or(0.0);
}

Measurer::Frame Measurer::frame(const WantedPoint& point) {
  const MachineLock working(MachineLock::For::work);
  const StoredRun run = open(point);
  const TimingContext context{device_, techniques_, scene_, options_, width_, height_};
  PipelineExecutor executor(device_, techniques_, scene_, point.loaded->pipeline,
                            renderOptionsOf(context, run.point));
  // The first frame of a process also compiles programs for the device, which may take several times as long
  // as the frame.
  constexpr double kLongMs = 10000.0;
  double milliseconds = executor.render(options_.time, 0, PipelineExecutor::Images::no).frameMs;
  if (milliseconds < kLongMs) {
    executor.invalidate();
    milliseconds = executor.render(options_.time, 0, PipelineExecutor::Images::no).frameMs;
  }
  return {milliseconds / 1000.0, executor.readsSeed()};
}

void Measurer::lookAt(const std::vector<WantedPoint>& points) {
  for (const WantedPoint& point : points) {
    if (wasLookedAt(point)) continue;
    Frame& known = frames_[point.loaded];
    whyFailed([&] { known = frame(point); });
    logDetails("{}: a frame takes {:.3f} s", text(point), known.seconds);
  }
}

double Measurer::frameSeconds(const WantedPoint& point) {
  lookAt({point});
  return knownFrameSeconds(point);
}

double Measurer::knownFrameSeconds(const WantedPoint& point) const {
  return framesOf(point.point.parameters) * frames_.at(point.loaded).seconds;
}

std::string Measurer::subjectOf(const WantedPoint& point) const {
  return sceneShown_ + ", " + point.loaded->shown;
}

double Measurer::plannedSeconds(const WantedPoint& point, const std::string& work) const {
  // From the committed pipelines on the Cornell box (bench/point_cost). Seeds are for errors; their images
  // are compared with references.
  constexpr double kTimesFrames = 11.0, kErrorsFrames = 5.0, kSeedsFrames = 10.0, kSeconds = 0.05;
  constexpr double kPixelSeconds = 3e-5;
  const double frame = knownFrameSeconds(point);
  if (work == kTimesWork) return kTimesFrames * frame + kSeconds;
  const bool seeds = frames_.at(point.loaded).readsSeed;
  return (kErrorsFrames + (seeds ? kSeedsFrames : 0.0)) * frame + kSeconds + kPixelSeconds * width_ * height_;
}

void Measurer::noteCost(const WantedPoint& point, const std::string& work, double seconds) {
  if (wasLookedAt(point)) costs_->add(subjectOf(point), work, plannedSeconds(point, work), seconds);
}

double Measurer::mostSeconds(const WantedPoint& point) {
  // The bound of a whole point is tighter than those of its parts.
  constexpr double kFrames = 14.0, kFramesWithSeeds = 24.0, kSeconds = 1.0;
  const double frame = frameSeconds(point);
  const std::string subject = subjectOf(point);
  const auto errors = costs_->most(subject, kErrorsWork, plannedSeconds(point, kErrorsWork));
  const auto times = costs_->most(subject, kTimesWork, plannedSeconds(point, kTimesWork));
  if (errors && times) return *errors + *times;
  return (frames_.at(point.loaded).readsSeed ? kFramesWithSeeds : kFrames) * frame + kSeconds;
}

double Measurer::expectedSeconds(const WantedPoint& point, const std::string& work) const {
  const double planned = plannedSeconds(point, work);
  return costs_->expected(subjectOf(point), work, planned).value_or(planned);
}

double Measurer::expectedSeconds(const WantedPoint& point) const {
  if (wasLookedAt(point)) return expectedSeconds(point, kErrorsWork) + expectedSeconds(point, kTimesWork);
  return costs_->expected(point.loaded->shown, kPointWork, framesOf(point.point.parameters)).value_or(0.0);
}

double Measurer::secondsLeft(const std::vector<WantedPoint>& points, double room) const {
  double left = 0.0;
  std::set<std::string> counted = done_;
  for (std::size_t i = 0; i < underWay_.size(); ++i) {
    counted.insert(idOf(underWay_[i]));
    if (!wasLookedAt(underWay_[i])) continue;
    if (i >= untimedDone_) left += expectedSeconds(underWay_[i], kErrorsWork);
    left += expectedSeconds(underWay_[i], kTimesWork);
  }
  for (const WantedPoint& point : points) {
    if (!counted.insert(idOf(point)).second) continue;
    const double seconds = expectedSeconds(point);
    if (left + seconds <= room) left += seconds;
  }
  return left;
}

double Measurer::controlSeconds(const std::vector<WantedPoint>& points, std::size_t most) const {
  double seconds = 0.0;
  for (std::size_t i = 0; i < std::min(most, points.size()); ++i)
    if (wasLookedAt(points[i])) seconds += expectedSeconds(points[i], kTimesWork);
  return seconds;
}

double Measurer::secondsOf(const WantedPoint& point) const {
  const auto found = seconds_.find(key(point));
  return found == seconds_.end() ? 0.0 : found->second;
}

std::map<std::string, double> Measurer::partsOf(const WantedPoint& point) const {
  const auto found = parts_.find(key(point));
  return found == parts_.end() ? std::map<std::string, double>() : found->second;
}

bool Measurer::takeUp(Entry& entry) const {
  const std::string key = entry.run.identity.key();
  std::optional<StoredRun> kept = store_.findUntimed(key);
  if (!kept) return false;
  std::vector<StoredImage> images = store_.images(key);
  if (images_ == Images::kept && images.empty()) return false;
  logInformation("{}: taken up from {}, but for its times", runText(entry.run), store_.file().string());
  nameAs(kept->point, entry.run.point);
  entry.run.point = std::move(kept->point);
  entry.images = std::move(images);
  return true;
}

void Measurer::measureUntimed(Entry& entry) {
  logInformation("{}", runText(entry.run));
  const std::string why = whyFailed([&] {
    PointRecord record;
    record.point = entry.run.point;
    const ReportOptions options = optionsOf(entry.run.identity);
    const MeasureContext context{{device_, techniques_, scene_, options, width_, height_}, reference()};
    measureErrors(context, entry.wanted.loaded->pipeline, record);
    measureFlicker(context, entry.wanted.loaded->pipeline, record);
    if (options_.budgetSeconds > 0.0)
      record.point.whyNotCounted = "a frame of its own counts it, for which there is no time within a budget";
    else
      countWork(context, entry.wanted.loaded->pipeline, record.point);
    if (!voxelReferences_) voxelReferences_.emplace(scene_, options_.time, options_.camera, width_, height_);
    {
      const Measuring voxels(record.point, "voxels");
      judgeVoxels(context, entry.wanted.loaded->pipeline, *voxelReferences_, record.point);
    }
    entry.run.point = std::move(record.point);
    if (images_ == Images::kept) entry.images = storedImages(record.images);
  });
  entry.run.created = dateText();
  if (why.empty()) {
    store_.addUntimed(entry.run, entry.images);
  } else {
    failed(entry.run, why);
    store_.add(entry.run);
  }
  noteProgress();
}

void Measurer::measureBatch(Batch& batch, const std::function<void(std::size_t, std::size_t)>& done) {
  using Clock = std::chrono::steady_clock;
  const auto secondsSince = [](Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
  };
  std::vector<std::string> keys;
  for (const Entry& entry : batch) keys.push_back(entry.run.identity.key());
  underWay_.clear();
  untimedDone_ = 0;
  for (const Entry& entry : batch) underWay_.push_back(entry.wanted);
  if (done && estimates_) lookAt(underWay_);
  for (Entry& entry : batch) {
    const MachineLock working(MachineLock::For::work);
    const Clock::time_point start = Clock::now();
    const bool takenUp = takeUp(entry);
    if (!takenUp) measureUntimed(entry);
    const double seconds = secondsSince(start);
    seconds_[entry.run.identity.key()] = seconds;
    ++untimedDone_;
    if (!takenUp && entry.run.point.failure.empty()) noteCost(entry.wanted, kErrorsWork, seconds);
    store_.claim(keys);  // still at work
    if (into_ != nullptr) into_->claimFor(store_.file(), keys);
    if (done && &entry != &batch.back()) done(1, 0);
  }
  const Clock::time_point start = Clock::now();
  const MachineState before = machineState();
  timeTogether(batch);
  const MachineState after = machineState();
  for (Entry& entry : batch) {
    entry.run.node = nodeName();
    entry.run.before = before;
    entry.run.after = after;
    entry.run.seconds = seconds_[entry.run.identity.key()];
    std::string parts;
    double sum = 0.0;
    parts_[entry.run.identity.key()] = entry.run.point.measuringSeconds;
    for (const auto& [what, seconds] : entry.run.point.measuringSeconds) {
      parts += fmt::format(", {} {:.2f}", what, seconds);
      sum += seconds;
    }
    logDetails("{}: {:.2f} s, {:.1f} times its frame of {:.3f} s{}", runText(entry.run), sum,
               1000.0 * sum / entry.run.point.frameMs.median, entry.run.point.frameMs.median / 1000.0, parts);
  }
  // The batch's time is shared by frame time, as if all points had equally many frames.
  double frames = 0.0;
  for (const Entry& entry : batch) frames += entry.run.point.frameMs.median;
  const double all = secondsSince(start);
  for (Entry& entry : batch) {
    if (!entry.run.point.failure.empty() || !(entry.run.point.frameMs.median > 0.0)) continue;
    const WantedPoint& wanted = entry.wanted;
    const double seconds = all * entry.run.point.frameMs.median / frames;
    double& whole = seconds_[entry.run.identity.key()];
    whole += seconds;
    entry.run.seconds = whole;
    noteCost(wanted, kTimesWork, seconds);
    costs_->add(wanted.loaded->shown, kPointWork, framesOf(wanted.point.parameters), whole);
  }
}

void Measurer::timeTogether(Batch& batch) {
  std::vector<Turn> turns;
  std::vector<Entry*> entries;
  for (Entry& entry : batch) {
    if (!entry.run.point.failure.empty()) continue;
    entries.push_back(&entry);
    turns.push_back({runText(entry.run), [&](const std::shared_ptr<TransientMemory>& memory) {
                       const ReportOptions options = optionsOf(entry.run.identity);
                       return TimedPoint({device_, techniques_, scene_, options, width_, height_, memory},
                                         entry.wanted.loaded->pipeline, entry.run.point);
                     }});
  }
  const int repeats = std::max(1, options_.repeats);
  timeInTurns(device_, turns, repeats, repeats);
  for (std::size_t i = 0; i < turns.size(); ++i)
    if (!turns[i].failure.empty()) failed(entries[i]->run, turns[i].failure);
}

}  // namespace lumivox::experiment
