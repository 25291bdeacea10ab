#include "lumivox/analysis/same_pipelines.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace lumivox {
namespace {

/// In any order: passes that need nothing of each other run as their text has them.
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
  const ReportPoint* defaults = nullptr;
  std::set<std::vector<std::string>> passes;  ///< at all of its points
};

std::vector<OnePipeline> pipelinesOf(const std::vector<const ReportPoint*>& points) {
  std::vector<OnePipeline> pipelines;
  for (const ReportPoint* point : points) {
    if (!point->failure.empty() || point->passOrder.empty()) continue;
    auto own = std::find_if(pipelines.begin(), pipelines.end(),
                            [&](const OnePipeline& one) { return one.file == point->pipeline; });
    if (own == pipelines.end()) own = pipelines.insert(pipelines.end(), {point->pipeline, nullptr, {}});
    if (point->sweep.empty() && own->defaults == nullptr) own->defaults = point;
    own->passes.insert(passesOf(*point));
  }
  const auto lacksDefaults = [](const OnePipeline& one) {
    return one.defaults == nullptr || one.defaults->errors.empty();
  };
  pipelines.erase(std::remove_if(pipelines.begin(), pipelines.end(), lacksDefaults), pipelines.end());
  std::stable_sort(pipelines.begin(), pipelines.end(), [](const OnePipeline& a, const OnePipeline& b) {
    return a.defaults->parameters.size() < b.defaults->parameters.size();
  });
  return pipelines;
}

}  // namespace

std::map<std::string, std::string> samePipelines(const std::vector<const ReportPoint*>& points) {
  std::map<std::string, std::string> result;
  const std::vector<OnePipeline> pipelines = pipelinesOf(points);
  for (std::size_t i = 0; i < pipelines.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const OnePipeline &one = pipelines[i], &other = pipelines[j];
      if (result.count(other.file) != 0 || !same(*one.defaults, *other.defaults) ||
          !std::includes(other.passes.begin(), other.passes.end(), one.passes.begin(), one.passes.end()))
        continue;
      result[one.file] = other.file;
      break;
    }
  return result;
}

}  // namespace lumivox
