#include "lumivox/analysis/same_pipelines.h"

#include <algorithm>
#include <cmath>

namespace lumivox {
namespace {

/// Sorted passes of a point: independent passes run in text order, which must not matter.
std::vector<std::string> passesOf(const ReportPoint& point) {
  std::vector<std::string> passes = point.passOrder;
  std::sort(passes.begin(), passes.end());
  return passes;
}

bool sameNumbers(const ComponentError& a, const ComponentError& b) {
  if (a.component != b.component || a.reference != b.reference || a.bias != b.bias) return false;
  const std::vector<NamedMetric> first = metricsOf(a), second = metricsOf(b);
  return std::equal(first.begin(), first.end(), second.begin(), second.end(),
                    [](const NamedMetric& one, const NamedMetric& other) {
                      return one.measured.value == other.measured.value ||
                             (std::isnan(one.measured.value) && std::isnan(other.measured.value));
                    });
}

bool same(const ReportPoint& a, const ReportPoint& b) {
  return passesOf(a) == passesOf(b) && a.passWork == b.passWork &&
         std::equal(a.errors.begin(), a.errors.end(), b.errors.begin(), b.errors.end(), sameNumbers);
}

struct OnePipeline {
  std::string file;
  std::vector<const ReportPoint*> points;
};

/// Pipelines with the fewest parameters come first.
std::vector<OnePipeline> pipelinesOf(const std::vector<const ReportPoint*>& points) {
  std::vector<OnePipeline> pipelines;
  for (const ReportPoint* point : points) {
    if (!point->failure.empty() || point->passOrder.empty() || point->errors.empty()) continue;
    auto own = std::find_if(pipelines.begin(), pipelines.end(),
                            [&](const OnePipeline& one) { return one.file == point->pipeline; });
    if (own == pipelines.end()) own = pipelines.insert(pipelines.end(), {point->pipeline, {}});
    own->points.push_back(point);
  }
  std::stable_sort(pipelines.begin(), pipelines.end(), [](const OnePipeline& a, const OnePipeline& b) {
    return a.points.front()->parameters.size() < b.points.front()->parameters.size();
  });
  return pipelines;
}

bool holdsAll(const OnePipeline& other, const OnePipeline& one) {
  return std::all_of(one.points.begin(), one.points.end(), [&](const ReportPoint* point) {
    return std::any_of(other.points.begin(), other.points.end(),
                       [&](const ReportPoint* candidate) { return same(*point, *candidate); });
  });
}

}  // namespace

std::map<std::string, std::string> samePipelines(const std::vector<const ReportPoint*>& points) {
  std::map<std::string, std::string> result;
  const std::vector<OnePipeline> pipelines = pipelinesOf(points);
  for (std::size_t i = 0; i < pipelines.size(); ++i)
    for (std::size_t j = 0; j < i && result.count(pipelines[i].file) == 0; ++j)
      if (result.count(pipelines[j].file) == 0 && holdsAll(pipelines[j], pipelines[i]))
        result[pipelines[i].file] = pipelines[j].file;
  return result;
}

}  // namespace lumivox
