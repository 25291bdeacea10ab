#include "lumivox/experiment/tune.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "experiment/budget.h"
#include "experiment/measurer.h"
#include "experiment/plan.h"
#include "lumivox/analysis/comparison.h"
#include "lumivox/base/error.h"
#include "lumivox/base/log.h"
#include "lumivox/base/terminal.h"
#include "lumivox/pipeline/pass.h"

namespace lumivox {
namespace {

using namespace experiment;

constexpr double kNearLimit = 2.0;  // times the limit; points of the Pareto front beyond it are not followed

/// Whether a parameter of the pipeline sets a whole number of some pass.
bool isWhole(const Pipeline& pipeline, TechniqueSource& techniques, const std::string& name) {
  for (const PassText& text : pipeline.passes) {
    const Technique* technique = techniques.technique(text.technique);
    const PassEntry* entry = technique == nullptr ? nullptr : technique->find(text.pass);
    if (entry == nullptr || text.block == nullptr) continue;
    const std::unique_ptr<Pass> pass = entry->make();
    for (const dsl::Item& item : text.block->items) {
      if (!item.property || item.property->values.empty()) continue;
      const dsl::Value& value = item.property->values.front();
      if (value.kind != dsl::ValueKind::parameter || value.text != name) continue;
      for (const ParamBase* parameter : pass->parameters())
        if (parameter->name() == item.property->word && parameter->type() == ParamBase::Type::integer)
          return true;
    }
  }
  return false;
}

/// The pipeline's text with other defaults and with included files in place.
std::string textWith(const Pipeline& pipeline, const ParameterValues& values) {
  dsl::Document document = dsl::parseFile(pipeline.file);
  for (dsl::Item& top : document.items) {
    if (!top.block || top.block->word != "pipeline") continue;
    for (dsl::Item& item : top.block->items) {
      if (!item.property || item.property->word != "param" || item.property->values.size() < 2) continue;
      const auto found = values.find(item.property->values[0].text);
      if (found == values.end()) continue;
      dsl::Value& value = item.property->values[1];
      if (!found->second.word.empty()) {
        value.text = found->second.word;
      } else {
        value.number = value.unit ? found->second.number / value.unit->toBase : found->second.number;
        value.text = fmt::format("{}", value.number);
      }
    }
  }
  return dsl::format(document);
}

class Search {
 public:
  Search(TechniqueSource& techniques, const TuneOptions& options, Measurer& measurer)
      : techniques_(techniques), options_(options), measurer_(measurer) {}

  /// Renders a frame of each pipeline among the first points that the store lacks, says how long the search
  /// takes at most, makes the reference, and starts the budget.
  void begin(const std::vector<WantedPoint>& first) {
    const auto most = static_cast<std::size_t>(options_.evaluations);
    std::vector<WantedPoint> missing;
    for (const WantedPoint& point : missingOf(first))
      if (missing.size() < most) missing.push_back(point);
    measurer_.lookAt(missing);
    first_ = first;
    pending_ = missing;
    finished_ = std::min(most, first.size()) - missing.size();
    const std::string atMost = fmt::format("tuning: {} points at most, {} of the first {} in the store", most,
                                           finished_, std::min(most, first.size()));
    const std::optional<double> left = secondsLeft();
    const double budget = options_.measure.budgetSeconds;
    logInformation(
        "{}: {}; {}", atMost,
        left ? fmt::format("about {} of measuring at most, after the reference", durationText(*left))
             : std::string("how long further ones take is not known before the first of them is measured"),
        budget > 0.0 ? fmt::format("begun is what ends within {} (--budget)", durationText(budget))
                     : std::string("--budget TIME ends it earlier"));
    if (!missing.empty()) measurer_.makeReference(first);
    finished_ = 0;
    budget_ = Budget(options_.measure.budgetSeconds);
  }

  /// Measures points that were not looked at yet while there is time; false when the evaluations are used up.
  bool look(const std::vector<WantedPoint>& points) {
    std::vector<WantedPoint> fresh;
    for (const WantedPoint& point : points) {
      if (known_.size() >= static_cast<std::size_t>(options_.evaluations)) {
        usedUp_ = true;
        break;
      }
      if (known_.insert(measurer_.key(point)).second) fresh.push_back(point);
    }
    pending_ = missingOf(fresh);
    finished_ += fresh.size() - pending_.size();
    // Keeps their order, although the store holds some of them before others are measured.
    std::vector<WantedPoint> left = pending_;
    for (std::vector<WantedPoint> some = begun(left); !some.empty(); some = begun(left))
      measurer_.fetch(some, [&](std::size_t own, std::size_t others) { tell(own, others); });
    std::set<std::string> leftOut;
    for (const WantedPoint& point : left) leftOut.insert(measurer_.key(point));
    std::erase_if(fresh, [&](const WantedPoint& point) { return leftOut.contains(measurer_.key(point)); });
    leftOut_.insert(leftOut_.end(), left.begin(), left.end());
    pending_.clear();
    const std::vector<StoredRun> runs = measurer_.fetch(fresh);
    for (std::size_t i = 0; i < runs.size(); ++i) add(fresh[i], runs[i]);
    markFront();
    return !usedUp_;
  }

  /// Neighbours of the points ahead and of the best that were not followed yet. The Pareto front itself would
  /// be too much: it holds everything that cannot be told from the best, which on a plateau of the error with
  /// nearly equal times would use up the evaluations.
  std::vector<WantedPoint> neighbours() {
    std::vector<std::vector<WantedPoint>> lists;
    for (const std::size_t index : ahead()) follow(seen_[index], lists);
    if (const std::optional<std::size_t> index = leastOf(tradeOffs(), fitting(), sought()))
      follow(seen_[*index], lists);
    // In turns, so that all points of the Pareto front share few evaluations.
    std::vector<WantedPoint> result;
    for (std::size_t i = 0; result.size() < total(lists); ++i)
      for (const std::vector<WantedPoint>& list : lists)
        if (i < list.size()) result.push_back(list[i]);
    return result;
  }

  TuneResult finish() {
    TuneResult result;
    result.exhausted = !usedUp_ && leftOut_.empty();
    result.usedUp = usedUp_;
    result.leftOut = leftOut_.size();
    if (measured_ == 0)
      for (const WantedPoint& point : leftOut_) {
        const double seconds = measurer_.mostSeconds(point);
        result.neededSeconds =
            result.neededSeconds == 0.0 ? seconds : std::min(result.neededSeconds, seconds);
      }
    std::stable_sort(seen_.begin(), seen_.end(), [](const Seen& a, const Seen& b) {
      return a.point.tradeOff.timeMs.value < b.point.tradeOff.timeMs.value;
    });
    for (const Seen& seen : seen_) result.seen.push_back(seen.point);
    result.least = leastOf(tradeOffs(), fitting(), sought());
    result.winner = leastWithinNoise(tradeOffs(), fitting(), sought(), timeShare());
    if (result.winner) {
      const WantedPoint& winner = seen_[*result.winner].wanted;
      result.pipelineText = textWith(winner.loaded->pipeline, winner.point.parameters);
    }
    return result;
  }

 private:
  struct Seen {
    TunedPoint point;
    WantedPoint wanted;
    bool followed = false;
  };

  static std::size_t total(const std::vector<std::vector<WantedPoint>>& lists) {
    std::size_t sum = 0;
    for (const std::vector<WantedPoint>& list : lists) sum += list.size();
    return sum;
  }

  std::vector<WantedPoint> missingOf(const std::vector<WantedPoint>& points) const {
    const std::vector<bool> held = measurer_.held(points, false);
    std::vector<WantedPoint> missing;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (!held[i]) missing.push_back(points[i]);
    return missing;
  }

  /// Removes the points that are begun next: all, or within a budget a batch of those that would end in time.
  std::vector<WantedPoint> begun(std::vector<WantedPoint>& points) {
    if (!budget_.isLimited()) return std::exchange(points, {});
    std::vector<WantedPoint> begun, left;
    double seconds = 0.0;
    for (WantedPoint& point : points) {
      const double most = measurer_.mostSeconds(point);
      const bool fits = begun.size() < Measurer::kBatch && budget_.allows(seconds + most);
      if (fits) seconds += most;
      (fits ? begun : left).push_back(std::move(point));
    }
    points = std::move(left);
    return begun;
  }

  /// Longest remaining time, s: the known points, and as many further ones of the followed pipelines as there
  /// may be. Empty where their costs are unknown.
  std::optional<double> secondsLeft() const {
    const double room = budget_.left(), known = measurer_.secondsLeft(pending_, room);
    const auto most = static_cast<std::size_t>(options_.evaluations);
    const std::size_t further = most - std::max(known_.size(), std::min(most, first_.size()));
    if (further == 0) return known;
    double sum = 0.0;
    std::size_t pipelines = 0;
    std::set<const LoadedPipeline*> seen;
    for (const WantedPoint& point : first_) {
      if (!measurer_.wasLookedAt(point) || !seen.insert(point.loaded).second) continue;
      if (options_.frameTimeMs &&
          1000.0 * measurer_.knownFrameSeconds(point) > kNearLimit * *options_.frameTimeMs)
        continue;
      sum += measurer_.expectedSeconds(point);
      ++pipelines;
    }
    if (seen.empty()) return std::nullopt;
    if (pipelines == 0) return known;
    return std::min(room, known + sum / static_cast<double>(pipelines) * static_cast<double>(further));
  }

  /// Tells the progress of the search towards the most points that it may look at. Stored points cost no
  /// time.
  void tell(std::size_t own, std::size_t others) {
    finished_ += own + others;
    measured_ += own;
    if (!options_.measure.progress) return;
    options_.measure.progress(finished_, static_cast<std::size_t>(options_.evaluations),
                              secondsLeft().value_or(kUnknownSeconds));
  }

  void add(const WantedPoint& wanted, const StoredRun& run) {
    if (!run.point.failure.empty() || run.point.frameMs.repeats == 0) return;
    for (const ComponentError& error : run.point.errors) {
      if (error.output != options_.output) continue;
      // A component with one reference has only the first error, which then stands for both.
      const bool only =
          std::count_if(run.point.errors.begin(), run.point.errors.end(),
                        [&](const ComponentError& other) { return other.output == options_.output; }) == 1;
      if (error.bias != options_.bias && !only) continue;
      const Measured number = errorNumber(error, options_.metric);
      if (!std::isfinite(number.value)) continue;
      TunedPoint point{run,  {medianOf(run.point.frameMs), number}, error.component, error.reference, false,
                       false};
      point.fits = withinLimit(point.tradeOff, 1.0);
      seen_.push_back({std::move(point), wanted, false});
    }
  }

  std::vector<TradeOff> tradeOffs() const {
    std::vector<TradeOff> result;
    for (const Seen& seen : seen_) result.push_back(seen.point.tradeOff);
    return result;
  }

  void markFront() {
    const std::vector<std::optional<std::size_t>> beaten = beatenBy(tradeOffs(), timeShare());
    for (std::size_t i = 0; i < seen_.size(); ++i) seen_[i].point.onFront = !beaten[i];
  }

  double timeShare() const { return std::max(kSignificantTimeShare, measurer_.floor().frame); }

  /// The quantity to minimise; the other one is limited.
  Measured TradeOff::*sought() const { return options_.frameTimeMs ? &TradeOff::error : &TradeOff::timeMs; }

  /// The points of the front within the limit.
  std::vector<std::size_t> fitting() const {
    std::vector<std::size_t> result;
    for (std::size_t i = 0; i < seen_.size(); ++i)
      if (seen_[i].point.fits && seen_[i].point.onFront) result.push_back(i);
    return result;
  }

  /// Among the points that no other beats in value, sorted by time, those whose error differs from the last
  /// one's, or may do so within its uncertainty.
  std::vector<std::size_t> ahead() const {
    const std::vector<TradeOff> points = tradeOffs();
    std::vector<std::size_t> result;
    for (const std::size_t index : frontByValue(points))
      if (result.empty() || !decidable(points[result.back()].error, points[index].error) ||
          differ(points[result.back()].error, points[index].error))
        result.push_back(index);
    return result;
  }

  void follow(Seen& seen, std::vector<std::vector<WantedPoint>>& lists) {
    if (seen.followed || !withinLimit(seen.point.tradeOff, kNearLimit)) return;
    seen.followed = true;
    lists.emplace_back();
    addNeighbours(seen.wanted, lists.back());
  }

  /// Whether a point is at most so many times the limit.
  bool withinLimit(const TradeOff& point, double times) const {
    return options_.frameTimeMs ? point.timeMs.value <= times * *options_.frameTimeMs
                                : point.error.value <= times * *options_.errorLimit;
  }

  void addNeighbours(const WantedPoint& wanted, std::vector<WantedPoint>& result) {
    const Pipeline& pipeline = wanted.loaded->pipeline;
    if (options_.measure.frames > 1 && isProgressive(pipeline, techniques_)) {
      const int now = framesOf(wanted.point.parameters);
      for (const int frames : {2 * now, now / 2}) {
        if (frames < 1 || frames > options_.measure.frames) continue;
        WantedPoint neighbour = wanted;
        neighbour.point.sweep = "tune";
        neighbour.point.isDefault = false;
        neighbour.point.parameters[kAccumulatedFrames].number = frames;
        if (frames == 1) neighbour.point.parameters.erase(kAccumulatedFrames);
        result.push_back(std::move(neighbour));
      }
    }
    for (const PipelineParameter& parameter : pipeline.parameters) {
      // Parameters set on the command line are kept.
      if (wanted.loaded->settings.count(parameter.name) != 0) continue;
      const ParameterValue& now = wanted.point.parameters.at(parameter.name);
      for (ParameterValue& value : steps(pipeline, parameter, now)) {
        if (value.text() == now.text() || !parameter.misfit(value).empty()) continue;
        WantedPoint neighbour = wanted;
        neighbour.point.sweep = "tune";
        neighbour.point.isDefault = false;
        neighbour.point.parameters[parameter.name] = std::move(value);
        result.push_back(std::move(neighbour));
      }
    }
  }

  std::vector<ParameterValue> steps(const Pipeline& pipeline, const PipelineParameter& parameter,
                                    const ParameterValue& now) const {
    std::vector<ParameterValue> result;
    for (const std::string& choice : parameter.choices) {
      ParameterValue value = now;
      value.word = choice;
      result.push_back(value);
    }
    if (!now.word.empty() || !parameter.low || !parameter.high) return result;
    const bool whole = isWhole(pipeline, techniques_, parameter.name);
    const auto step = [&](double number) {
      ParameterValue value = now;
      value.number = std::clamp(whole ? std::round(number) : number, *parameter.low, *parameter.high);
      result.push_back(value);
    };
    // Doubling and halving, then finer steps around: the Pareto front is followed down to a factor of
    // sqrt(2).
    for (const double factor : {2.0, 0.5, std::sqrt(2.0), std::sqrt(0.5)}) step(now.number * factor);
    if (now.number == 0.0) step(0.5 * *parameter.high);
    if (*parameter.low <= 0.0 && *parameter.high > 0.0) step(0.0);
    return result;
  }

  TechniqueSource& techniques_;
  const TuneOptions& options_;
  Measurer& measurer_;
  std::vector<Seen> seen_;
  std::set<std::string> known_;
  bool usedUp_ = false;
  std::size_t finished_ = 0, measured_ = 0;  ///< points, and those of them measured here
  Budget budget_{0.0};
  /// Points: the first of the search; those looked at now that the store lacked; those without time.
  std::vector<WantedPoint> first_, pending_, leftOut_;
};

void requireSensible(const TuneOptions& options) {
  if (options.measure.scenes.size() != 1) throw Error("tuning needs exactly one scene");
  if (options.frameTimeMs.has_value() == options.errorLimit.has_value())
    throw Error("tuning needs a frame time or an error, one of the two");
  if (options.frameTimeMs && !(*options.frameTimeMs > 0.0)) throw Error("the frame time must be above 0 ms");
  if (options.errorLimit && !(*options.errorLimit > 0.0)) throw Error("the error must be above 0");
  requireErrorMetric(options.metric);
}

}  // namespace

TuneResult tune(gpu::Device& device, TechniqueSet& techniques, const TuneOptions& options,
                ResultsStore& store, const std::function<Scene(const std::filesystem::path&)>& loadScene) {
  requireSensible(options);
  PipelineChoice choice(options.measure, techniques);
  const std::filesystem::path& file = options.measure.scenes.front();
  Measurer measurer(device, techniques, options.measure, store, loadScene(file), shownPath(file));
  std::vector<std::pair<std::string, std::string>> unsuited;
  std::vector<WantedPoint> first;
  std::set<std::string> outputs{kWholeImage};
  for (const LoadedPipeline* loaded : choice.forScene(measurer.scene(), unsuited)) {
    std::set<std::string> own{kWholeImage};
    for (const Pipeline::Output& output : loaded->pipeline.outputs) own.insert(output.name);
    outputs.insert(own.begin(), own.end());
    if (own.count(options.output) == 0) {
      unsuited.emplace_back(loaded->shown, fmt::format("it has no output '{}'", options.output));
      continue;
    }
    for (PlannedPoint& point : pointsFor(*loaded, techniques, options.measure))
      first.push_back({loaded, std::move(point)});
  }
  if (outputs.count(options.output) == 0)
    throw Error(fmt::format("no pipeline has an output '{}'; expected one of {}", options.output,
                            fmt::join(outputs, ", ")));
  if (options.measure.allRead) options.measure.allRead();

  Search search(techniques, options, measurer);
  // Defaults come first, so that even few evaluations see every technique.
  std::stable_partition(first.begin(), first.end(),
                        [](const WantedPoint& point) { return point.point.isDefault; });
  search.begin(first);
  for (bool more = search.look(first); more;) {
    const std::vector<WantedPoint> next = search.neighbours();
    if (next.empty()) break;
    logInformation("tuning: {} neighbours of the best points", next.size());
    more = search.look(next);
  }
  TuneResult result = search.finish();
  for (const auto& [pipeline, why] : unsuited) result.unsuited.push_back(pipeline + ": " + why);
  return result;
}

}  // namespace lumivox
