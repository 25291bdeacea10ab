#include "lumivox/analysis/changes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "lumivox/analysis/comparison.h"
#include "lumivox/results/text.h"

namespace lumivox {

namespace {

namespace fs = std::filesystem;

std::string pointName(const StoredRun& run) {
  std::string text =
      fmt::format("{}, {}: {}", fs::path(run.point.scene).stem().string(),
                  fs::path(run.point.pipeline).stem().string(), pointText(run.point.parameters));
  if (run.identity.time != 0.0) text += fmt::format(", {} s", run.identity.time);
  if (!run.identity.kept.empty()) text += fmt::format(", keeping {}", fmt::join(run.identity.kept, " "));
  if (run.identity.seed != 1) text += fmt::format(", seed {}", run.identity.seed);
  return text + (run.identity.camera.empty() ? "" : ", camera " + run.identity.camera);
}

class Comparison {
 public:
  explicit Comparison(const TimeFloor& floor) : floor_(floor) {}

  void compare(const std::string& point, const StoredRun& before, const StoredRun& after) {
    point_ = point;
    if (!before.point.failure.empty() || !after.point.failure.empty()) {
      if (before.point.failure != after.point.failure)
        result.incomparable.push_back(fmt::format("{}: {}", point,
                                                  after.point.failure.empty()
                                                      ? "it failed before: " + before.point.failure
                                                      : "it fails now: " + after.point.failure));
      return;
    }
    ++result.compared;
    compareTimes(before, after);
    compareErrors(before, after);
  }

  RunComparison result;

 private:
  void compareTimes(const StoredRun& before, const StoredRun& after) {
    const RunIdentity &a = before.identity, &b = after.identity;
    if (a.device != b.device || a.driver != b.driver || a.host != b.host) {
      result.incomparable.push_back(point_ + ": times of different devices, drivers or hosts");
      return;
    }
    if (a.width != b.width || a.height != b.height) return;  // reported with the errors
    addTime("frame ms", before.point.frameMs, after.point.frameMs, floor_.frame);
    addTime("next frame ms", before.point.nextFrameMs, after.point.nextFrameMs, floor_.nextFrame);
    for (const auto& [pass, time] : before.point.passDeviceMs)
      if (const auto other = after.point.passDeviceMs.find(pass); other != after.point.passDeviceMs.end())
        addTime("pass " + pass + " ms", time, other->second, floor_.frame);
    add("peak bytes", {static_cast<double>(before.point.peakBytes), 0.0},
        {static_cast<double>(after.point.peakBytes), 0.0}, true, 0.0);
  }

  void compareErrors(const StoredRun& before, const StoredRun& after) {
    const RunIdentity &a = before.identity, &b = after.identity;
    if (a.sceneHash != b.sceneHash || a.width != b.width || a.height != b.height ||
        a.subpixels != b.subpixels) {
      result.incomparable.push_back(point_ + ": errors and times of other scene content or image size");
      return;
    }
    for (const ComponentError& error : before.point.errors)
      for (const ComponentError& other : after.point.errors)
        if (error.output == other.output && error.reference == other.reference) compareError(error, other);
  }

  void compareError(const ComponentError& before, const ComponentError& after) {
    const std::string what = before.output + " {} against " + before.reference;
    const auto named = [&](const char* metric) { return fmt::format(fmt::runtime(what), metric); };
    for (const char* metric : {"rmse", "flip"})
      add(named(metric), errorNumber(before, metric), errorNumber(after, metric), true, 0.0);
    const Measured x = errorNumber(before, "mean_ratio"), y = errorNumber(after, "mean_ratio");
    if (!std::isnan(x.value) && !std::isnan(y.value))
      add(named("mean ratio"), x, y,
          std::abs(y.value - 1.0) < std::abs(x.value - 1.0) ? y.value < x.value : y.value > x.value, 0.0);
  }

  void addTime(const std::string& quantity, const TimingStatistics& before, const TimingStatistics& after,
               double floor) {
    if (before.repeats > 0 && after.repeats > 0)
      add(quantity, medianOf(before), medianOf(after), true, std::max(kSignificantTimeShare, floor));
  }

  void add(const std::string& quantity, const Measured& before, const Measured& after, bool lessIsBetter,
           double leastShare) {
    RunChange change{point_, quantity, before, after, 0.0, false, false, false};
    const double difference = after.value - before.value;
    change.sigmas = sigmasApart(before, after);
    change.significant = differ(before, after, leastShare);
    change.undecided = !decidable(before, after);
    change.better = lessIsBetter ? difference < 0.0 : difference > 0.0;
    result.changes.push_back(std::move(change));
  }

  const TimeFloor floor_;
  std::string point_;
};

std::map<std::string, const StoredRun*> lastOfEach(const std::vector<StoredRun>& runs) {
  std::map<std::string, const StoredRun*> result;
  for (const StoredRun& run : runs) result[pointName(run)] = &run;
  return result;
}

}  // namespace

RunComparison compareResults(const std::vector<StoredRun>& before, const std::vector<StoredRun>& after,
                             const TimeFloor& floor) {
  Comparison comparison(floor);
  if (before.size() == 1 && after.size() == 1) {
    const std::string a = pointName(before.front()), b = pointName(after.front());
    comparison.compare(a == b ? a : a + " -> " + b, before.front(), after.front());
    return std::move(comparison.result);
  }
  const auto old = lastOfEach(before), now = lastOfEach(after);
  for (const auto& [point, run] : old) {
    if (const auto found = now.find(point); found != now.end())
      comparison.compare(point, *run, *found->second);
    else
      comparison.result.onlyBefore.push_back(point);
  }
  for (const auto& [point, run] : now)
    if (old.find(point) == old.end()) comparison.result.onlyAfter.push_back(point);
  return std::move(comparison.result);
}

}  // namespace lumivox
