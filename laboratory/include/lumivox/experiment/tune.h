// Finding the technique and its parameters with the least error within a time, or the least time within an
// error, by measuring.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "lumivox/analysis/comparison.h"
#include "lumivox/experiment/report.h"
#include "lumivox/results/store.h"

namespace lumivox {

struct TuneOptions {
  /// One scene; `output` is not used; `progress`: of the evaluations. Within `budgetSeconds` the search
  /// begins no point that would end later.
  ReportOptions measure;
  std::optional<double> frameTimeMs;    ///< limit of a frame in which every kept pass runs
  std::optional<double> errorLimit;     ///< exactly one of the two
  std::string metric = kDefaultMetric;  ///< one of errorMetrics(), as errorNumber() reads it
  std::string output = kWholeImage;     ///< of the pipelines; those without it are left out
  bool bias = false;                    ///< against the technique's own model, not the full reference
  int evaluations = 60;                 ///< most points to look at, stored ones included
};

/// One point that the search looked at.
struct TunedPoint {
  StoredRun run;
  TradeOff tradeOff;
  std::string component, reference;  ///< light that is judged, and the layer that it is judged against
  bool onFront = false;              ///< no other point beats it: the rule of all fronts, beats()
  bool fits = false;                 ///< within the frame time, or the error
};

struct TuneResult {
  std::vector<TunedPoint> seen;       ///< by time
  std::optional<std::size_t> winner;  ///< into seen; none when nothing fits
  std::optional<std::size_t> least;   ///< into seen: the winner by value alone
  std::string pipelineText;           ///< the winner's pipeline with its parameters as the defaults
  bool exhausted = false;             ///< every neighbour of the points that are followed was looked at
  bool usedUp = false;                ///< there were more of them than evaluations
  std::size_t leftOut = 0;            ///< points for which there was no time
  double neededSeconds = 0.0;  ///< as ReportSummary's: the least budget that begins one, where none was
  std::vector<std::string> unsuited;  ///< "pipeline: why"
};

/// The search begins with the default and the sweeps of every suitable pipeline. Then, again and again, the
/// neighbours of points within twice the limit are measured: each declared parameter times 2, 1/2, sqrt(2)
/// and 1/sqrt(2), at 0 where its range begins there, and at its other words. Followed are the fastest point,
/// by rising time those whose error differs from that of the last one followed (differ()), and the least
/// error by value of all points within the frame time, or the least time within the error. The front also
/// contains points that cannot be told apart from these, which is not followed. The search ends when there
/// are none left, or after `evaluations`. The winner is chosen within noise: leastWithinNoise(). Throws as
/// makeReport; Error when the limits contradict themselves or the metric or output is unknown.
TuneResult tune(gpu::Device& device, TechniqueSet& techniques, const TuneOptions& options,
                ResultsStore& store, const std::function<Scene(const std::filesystem::path&)>& loadScene);

}  // namespace lumivox
