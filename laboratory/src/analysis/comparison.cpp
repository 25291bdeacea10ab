#include "lumivox/analysis/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "lumivox/analysis/same_pipelines.h"
#include "lumivox/base/error.h"
#include "lumivox/results/json.h"
#include "lumivox/results/text.h"

namespace lumivox {
namespace {

using Json = nlohmann::ordered_json;

/// Marks the least cell of a column and those within uncertainty of it.
void markBest(std::vector<ComparedPipeline>& pipelines, std::size_t column,
              std::vector<ComparedCell> ComparedPipeline::*table, double leastShare) {
  const auto reached = [](const ComparedCell& cell) {
    return cell.reached.reach == Reach::interpolated || cell.reached.reach == Reach::atMost;
  };
  const ComparedCell* least = nullptr;
  for (const ComparedPipeline& pipeline : pipelines) {
    const ComparedCell& cell = (pipeline.*table)[column];
    if (reached(cell) && (least == nullptr || cell.reached.value.value < least->reached.value.value))
      least = &cell;
  }
  for (ComparedPipeline& pipeline : pipelines) {
    ComparedCell& cell = (pipeline.*table)[column];
    cell.best = reached(cell) && !differ(least->reached.value, cell.reached.value, leastShare);
  }
}

std::vector<TradeOff> tradeOffsOf(const std::vector<ComparedPoint>& points) {
  std::vector<TradeOff> result;
  for (const ComparedPoint& point : points) result.push_back(point.tradeOff);
  return result;
}

void fillTables(PipelineComparison& comparison, const std::vector<TradeOff>& tradeOffs) {
  for (std::size_t i = 0; i < comparison.pipelines.size(); ++i) {
    ComparedPipeline& pipeline = comparison.pipelines[i];
    std::vector<TradeOff> own(tradeOffs.size());  // points of others stay 0 and are skipped
    for (std::size_t point = 0; point < tradeOffs.size(); ++point)
      if (comparison.points[point].pipeline == i) own[point] = tradeOffs[point];
    pipeline.front = frontByValue(own);
    for (const double timeMs : comparison.frameTimesMs)
      pipeline.atTime.push_back({errorAtTime(tradeOffs, pipeline.front, timeMs)});
    for (const double error : comparison.errors)
      pipeline.atError.push_back({timeAtError(tradeOffs, pipeline.front, error)});
  }
  for (std::size_t column = 0; column < comparison.frameTimesMs.size(); ++column)
    markBest(comparison.pipelines, column, &ComparedPipeline::atTime, 0.0);
  for (std::size_t column = 0; column < comparison.errors.size(); ++column)
    markBest(comparison.pipelines, column, &ComparedPipeline::atError, comparison.timeShare);
}

/// Per pipeline, the point of its Pareto front with the least error within a frame time.
std::vector<std::size_t> bestWithin(const PipelineComparison& comparison, double frameTimeMs) {
  std::vector<std::optional<std::size_t>> ofPipeline(comparison.pipelines.size());
  for (std::size_t i = 0; i < comparison.points.size(); ++i) {
    const ComparedPoint& point = comparison.points[i];
    if (point.beatenBy || point.tradeOff.timeMs.value > frameTimeMs) continue;
    std::optional<std::size_t>& own = ofPipeline[point.pipeline];
    if (!own || point.tradeOff.error.value < comparison.points[*own].tradeOff.error.value) own = i;
  }
  std::vector<std::size_t> best;
  for (const std::optional<std::size_t>& own : ofPipeline)
    if (own) best.push_back(*own);
  const auto error = [&](std::size_t index) { return comparison.points[index].tradeOff.error; };
  std::stable_sort(best.begin(), best.end(),
                   [&](std::size_t a, std::size_t b) { return error(a).value < error(b).value; });
  best.erase(std::remove_if(best.begin(), best.end(),
                            [&](std::size_t index) { return differ(error(best.front()), error(index)); }),
             best.end());
  return best;
}

void fillRanges(PipelineComparison& comparison) {
  for (const ComparedPoint& point : comparison.points) {
    std::vector<std::size_t> best = bestWithin(comparison, point.tradeOff.timeMs.value);
    if (!comparison.ranges.empty() && comparison.ranges.back().best == best) continue;
    if (!comparison.ranges.empty()) comparison.ranges.back().toMs = point.tradeOff.timeMs.value;
    comparison.ranges.push_back({point.tradeOff.timeMs.value, std::nullopt, std::move(best)});
  }
}

/// Smallest and largest of the numbers above 0.
std::pair<double, double> rangeOf(const std::vector<TradeOff>& tradeOffs, Measured TradeOff::*number) {
  double low = std::numeric_limits<double>::infinity(), high = 0.0;
  for (const TradeOff& tradeOff : tradeOffs) {
    const double value = (tradeOff.*number).value;
    if (!(value > 0.0)) continue;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  return {low, high};
}

std::vector<double> limitsOr(const std::vector<double>& given, const std::pair<double, double>& range) {
  if (given.empty()) return roundNumbers(range.first, range.second);
  std::vector<double> sorted = given;
  std::sort(sorted.begin(), sorted.end());
  return sorted;
}

std::string pipelineStem(const StoredRun& run) {
  return shortName(run.point.pipeline);
}

/// Everything that two runs must share to be compared in time and error.
std::string groupKey(const StoredRun& run) {
  const RunIdentity& identity = run.identity;
  return fmt::format("{}|{}|{}|{}x{}|{}|{}|{}|{}|{}|{}|", identity.sceneHash, identity.camera, identity.time,
                     identity.width, identity.height, identity.subpixels, identity.device, identity.driver,
                     identity.shaderInput, identity.host, fmt::join(identity.kept, " "));
}

std::string groupTitle(const StoredRun& run) {
  const RunIdentity& identity = run.identity;
  return fmt::format("{}, camera {}{}, {}x{}, on {}{}", shortName(run.point.scene), identity.camera,
                     identity.time == 0.0 ? "" : fmt::format(", {} s", identity.time), identity.width,
                     identity.height, identity.device,
                     identity.kept.empty() ? "" : fmt::format(", keeping {}", fmt::join(identity.kept, " ")));
}

std::string contentKey(const StoredRun& run) {
  std::string key = run.identity.pipelineHash + "|" + run.identity.framework;
  for (const auto& [name, hash] : run.identity.techniques) key += "|" + name + hash;
  return key;
}

bool isEqualForAll(const PipelineComparison& comparison) {
  if (comparison.pipelines.size() < 2) return false;
  std::vector<std::set<double>> errors(comparison.pipelines.size());
  for (const ComparedPoint& point : comparison.points)
    errors[point.pipeline].insert(point.tradeOff.error.value);
  return std::any_of(errors[0].begin(), errors[0].end(), [&](double error) {
    return std::all_of(errors.begin(), errors.end(),
                       [&](const std::set<double>& own) { return own.count(error) != 0; });
  });
}

/// How well the comparison separates pipelines; larger is better.
int tellingOf(const PipelineComparison& comparison) {
  if (comparison.front.empty()) return -1;
  if (comparison.component == name(Contributes::final)) return comparison.bias ? 1 : 2;
  const auto pipelines = static_cast<int>(comparison.pipelines.size());
  if (comparison.equalForAll || pipelines < 2 || comparison.component == name(Contributes::direct)) return 0;
  return 2 * pipelines + (comparison.bias ? 1 : 0);
}

Json cellsJson(const std::vector<double>& limits, const char* limitName, const char* valueName,
               const std::vector<ComparedCell>& cells) {
  Json list = Json::array();
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const Interpolated& reached = cells[i].reached;
    Json cell = {{limitName, limits[i]}, {"reach", name(reached.reach)}};
    if (reached.reach == Reach::interpolated || reached.reach == Reach::atMost) {
      cell[valueName] = numberJson(reached.value.value);
      cell["uncertainty"] = numberJson(reached.value.uncertainty);
      cell["between"] = {reached.from, reached.to};
      cell["best"] = cells[i].best;
    }
    list.push_back(std::move(cell));
  }
  return list;
}

Json pointJson(const PipelineComparison& comparison, const ComparedPoint& point) {
  Json parameters = Json::object();
  for (const auto& [name, value] : point.parameters) parameters[name] = value.text();
  return {{"source", point.source},
          {"pipeline", point.pipeline},
          {"file", comparison.pipelines[point.pipeline].pipeline},
          {"parameters", std::move(parameters)},
          {"frame_ms",
           {{"median", numberJson(point.frameMs.median)},
            {"lower_quartile", numberJson(point.frameMs.lowerQuartile)},
            {"upper_quartile", numberJson(point.frameMs.upperQuartile)},
            {"uncertainty", numberJson(point.tradeOff.timeMs.uncertainty)}}},
          {"error",
           {{"value", numberJson(point.tradeOff.error.value)},
            {"uncertainty", numberJson(point.tradeOff.error.uncertainty)}}},
          {"undecided", !point.tradeOff.timeMs.enoughRepeats || !point.tradeOff.error.enoughRepeats},
          {"on_front", !point.beatenBy},
          {"beaten_by", point.beatenBy ? Json(*point.beatenBy) : Json(nullptr)}};
}

}  // namespace

bool PipelineComparison::hasFront(std::size_t pipeline) const {
  return std::any_of(points.begin(), points.end(), [&](const ComparedPoint& point) {
    return point.pipeline == pipeline && !point.beatenBy;
  });
}

std::vector<std::string> comparableComponents() {
  std::vector<std::string> names;
  for (const Contributes component :
       {Contributes::indirectDiffuse, Contributes::indirectGlossy, Contributes::scattered,
        Contributes::ambientOcclusion, Contributes::direct, Contributes::final})
    names.emplace_back(name(component));
  return names;
}

std::vector<std::string> errorMetrics() {
  static const std::set<std::string> others{"ssim",         // 1 for the reference
                                            "mean_ratio",   // the same
                                            "bias",         // signed
                                            "exposure_ev",  // at which others were taken
                                            "noise_floor",  // of the reference alone
                                            "non_finite_image",
                                            "non_finite_reference"};
  std::vector<std::string> names;
  for (const NamedMetric& metric : metricsOf(ComponentError{}))
    if (others.count(metric.name) == 0) names.push_back(metric.name);
  return names;
}

void requireErrorMetric(const std::string& metric) {
  const std::vector<std::string> names = errorMetrics();
  if (std::find(names.begin(), names.end(), metric) != names.end()) return;
  const std::string nearest = nearestWord(metric, names);
  throw Error(fmt::format("there is no metric '{}' to compare by; expected one of {}{}", metric,
                          fmt::join(names, ", "),
                          nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
}

Measured errorNumber(const ComponentError& error, const std::string& metric) {
  for (const NamedMetric& one : metricsOf(error))
    if (one.name == metric) return one.measured;
  return {std::numeric_limits<double>::quiet_NaN(), 0.0};
}

std::vector<std::string> componentsOf(const std::vector<const ReportPoint*>& points) {
  std::vector<std::string> present;
  for (const std::string& component : comparableComponents()) {
    const auto has = [&](const ReportPoint* point) {
      return componentErrorOf(*point, component, true) != nullptr;
    };
    if (std::any_of(points.begin(), points.end(), has)) present.push_back(component);
  }
  return present;
}

const ComponentError* componentErrorOf(const ReportPoint& point, const std::string& component, bool bias) {
  const bool whole = component == name(Contributes::final);
  const ComponentError* only = nullptr;
  for (const ComponentError& error : point.errors) {
    if (error.component != component || (whole && error.output != kWholeImage)) continue;
    if (error.bias == bias) return &error;
    if (only == nullptr) only = &error;
  }
  return only;
}

PipelineComparison comparePipelines(const std::vector<const ReportPoint*>& points,
                                    const std::string& component, bool bias, const std::string& metric,
                                    const ComparisonLimits& limits) {
  PipelineComparison comparison;
  comparison.component = component;
  comparison.bias = bias;
  comparison.metric = metric;
  comparison.same = samePipelines(points);
  std::set<std::string> references;  // each technique is compared with the layer of its own model
  for (std::size_t source = 0; source < points.size(); ++source) {
    const ReportPoint& point = *points[source];
    const ComponentError* error = componentErrorOf(point, component, bias);
    if (error == nullptr || !point.failure.empty() || point.frameMs.repeats == 0 ||
        comparison.same.count(point.pipeline) != 0)
      continue;
    const Measured number = errorNumber(*error, metric);
    if (!std::isfinite(number.value)) continue;
    references.insert(error->reference);
    const auto same = [&](const ComparedPipeline& pipeline) { return pipeline.pipeline == point.pipeline; };
    auto pipeline = std::find_if(comparison.pipelines.begin(), comparison.pipelines.end(), same);
    if (pipeline == comparison.pipelines.end()) {
      comparison.pipelines.push_back({point.pipeline, error->output, {}, {}, {}});
      pipeline = std::prev(comparison.pipelines.end());
    }
    comparison.points.push_back({source,
                                 static_cast<std::size_t>(pipeline - comparison.pipelines.begin()),
                                 point.parameters,
                                 point.frameMs,
                                 {medianOf(point.frameMs), number},
                                 std::nullopt});
  }
  comparison.reference = fmt::format("{}", fmt::join(references, ", "));
  std::stable_sort(comparison.points.begin(), comparison.points.end(),
                   [](const ComparedPoint& a, const ComparedPoint& b) {
                     return a.tradeOff.timeMs.value < b.tradeOff.timeMs.value;
                   });
  const std::vector<TradeOff> tradeOffs = tradeOffsOf(comparison.points);
  comparison.timeShare = std::max(kSignificantTimeShare, limits.floor.frame);
  comparison.controls = limits.floor.controls;
  for (const TradeOff& one : tradeOffs)
    comparison.undecided += one.timeMs.enoughRepeats && one.error.enoughRepeats ? 0 : 1;
  const std::vector<std::optional<std::size_t>> beaten = beatenBy(tradeOffs, comparison.timeShare);
  for (std::size_t i = 0; i < beaten.size(); ++i) comparison.points[i].beatenBy = beaten[i];
  comparison.front = frontByValue(tradeOffs);
  comparison.frameTimesMs = limitsOr(limits.frameTimesMs, rangeOf(tradeOffs, &TradeOff::timeMs));
  comparison.errors = limitsOr(limits.errors, rangeOf(tradeOffs, &TradeOff::error));
  fillTables(comparison, tradeOffs);
  fillRanges(comparison);
  comparison.equalForAll = isEqualForAll(comparison);
  return comparison;
}

std::vector<PipelineComparison> compareComponents(const std::vector<const ReportPoint*>& points,
                                                  const std::vector<std::string>& metrics,
                                                  const ComparisonLimits& limits) {
  std::vector<PipelineComparison> result;
  for (const std::string& component : componentsOf(points))
    for (const bool bias : {false, true})
      for (const std::string& metric : metrics) {
        PipelineComparison comparison = comparePipelines(points, component, bias, metric, limits);
        const auto sameReference = [&](const PipelineComparison& other) {
          return other.component == component && other.metric == metric &&
                 other.reference == comparison.reference;
        };
        if (comparison.points.empty() || (bias && std::any_of(result.begin(), result.end(), sameReference)))
          continue;
        result.push_back(std::move(comparison));
      }
  return result;
}

std::optional<std::size_t> ledComparison(const std::vector<PipelineComparison>& comparisons) {
  if (comparisons.empty()) return std::nullopt;
  const bool hasDefault = std::any_of(comparisons.begin(), comparisons.end(),
                                      [](const auto& one) { return one.metric == kDefaultMetric; });
  const std::string metric = hasDefault ? kDefaultMetric : comparisons.front().metric;
  std::optional<std::size_t> led;
  for (std::size_t i = 0; i < comparisons.size(); ++i)
    if (comparisons[i].metric == metric && (!led || tellingOf(comparisons[i]) > tellingOf(comparisons[*led])))
      led = i;
  return led;
}

std::vector<ComparableRuns> comparableRuns(const std::vector<StoredRun>& runs) {
  std::vector<const StoredRun*> order;
  for (const StoredRun& run : runs) order.push_back(&run);
  std::stable_sort(order.begin(), order.end(),
                   [](const StoredRun* a, const StoredRun* b) { return a->created < b->created; });
  std::vector<ComparableRuns> groups;
  std::map<std::string, std::size_t> groupOf;
  std::map<std::string, std::string> contentOf;  // of the last run of a pipeline in a group
  for (const StoredRun* run : order) {
    contentOf[groupKey(*run) + pipelineStem(*run)] = contentKey(*run);
    groupOf.emplace(groupKey(*run), groupOf.size());
  }
  groups.resize(groupOf.size());
  std::map<std::string, std::size_t> places;  // of each point among its group's runs
  for (const StoredRun* run : order) {
    const std::string key = groupKey(*run);
    ComparableRuns& group = groups[groupOf.at(key)];
    group.title = groupTitle(*run);
    if (!run->point.failure.empty() || contentOf.at(key + pipelineStem(*run)) != contentKey(*run)) {
      ++group.passedOver;
      continue;
    }
    const auto [place, isNew] =
        places.emplace(key + pipelineStem(*run) + ":" + pointText(run->point.parameters), group.runs.size());
    if (isNew) {
      group.runs.push_back(run);
    } else {
      group.runs[place->second] = run;
      ++group.passedOver;
    }
  }
  return groups;
}

nlohmann::ordered_json toJson(const PipelineComparison& comparison) {
  Json json = {{"component", comparison.component},        {"against", comparison.bias ? "bias" : "misses"},
               {"reference", comparison.reference},        {"metric", comparison.metric},
               {"least_time_share", comparison.timeShare}, {"controls", comparison.controls},
               {"undecided", comparison.undecided},        {"front", comparison.front},
               {"equal_for_all", comparison.equalForAll},  {"same", comparison.same}};
  json["points"] = Json::array();
  for (const ComparedPoint& point : comparison.points) json["points"].push_back(pointJson(comparison, point));
  json["pipelines"] = Json::array();
  for (std::size_t i = 0; i < comparison.pipelines.size(); ++i) {
    const ComparedPipeline& pipeline = comparison.pipelines[i];
    json["pipelines"].push_back(
        {{"file", pipeline.pipeline},
         {"output", pipeline.output},
         {"on_front", comparison.hasFront(i)},
         {"front", pipeline.front},
         {"equal_time", cellsJson(comparison.frameTimesMs, "ms", "error", pipeline.atTime)},
         {"equal_error", cellsJson(comparison.errors, "error", "ms", pipeline.atError)}});
  }
  json["ranges"] = Json::array();
  for (const FrameTimeRange& range : comparison.ranges)
    json["ranges"].push_back({{"from_ms", range.fromMs},
                              {"to_ms", range.toMs ? Json(*range.toMs) : Json(nullptr)},
                              {"best", range.best}});
  return json;
}

}  // namespace lumivox
