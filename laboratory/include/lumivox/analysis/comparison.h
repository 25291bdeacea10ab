// All pipelines of a scene against each other: the front of error against time over all of their points, what
// each reaches in equal time and what each needs for equal error.
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "lumivox/analysis/interpolation.h"
#include "lumivox/results/runs.h"

namespace lumivox {

/// The default metric for comparing pipelines. FLIP is at most 1 in every pixel, so that a few bright pixels
/// do not dominate, and needs no choice of exposure (docs/metrics.md).
inline constexpr const char* kDefaultMetric = "flip";
/// The meaning of its number, shown at its first use on pages, in the terminal and in docs/metrics.md.
inline constexpr const char* kDefaultMetricSays =
    "HDR-FLIP: 0 where a viewer sees no difference, 1 at most; a ramp of greys made 2 %, 10 % and 50 % "
    "brighter has 0.04, 0.12 and 0.34.";

/// One point of a sweep, timed and judged.
struct ComparedPoint {
  std::size_t source = 0;    ///< into the points that were given
  std::size_t pipeline = 0;  ///< into PipelineComparison::pipelines
  ParameterValues parameters;
  TimingStatistics frameMs;
  TradeOff tradeOff;                    ///< of the median of frameMs
  std::optional<std::size_t> beatenBy;  ///< by the rule of beats(), into points; none: on the Pareto front
};

/// One cell of the tables.
struct ComparedCell {
  Interpolated reached;
  bool best = false;  ///< the least of its column, or not to be told apart from that (differ())
};

struct ComparedPipeline {
  std::string pipeline;  ///< file as given
  std::string output;    ///< that is judged
  /// Its points that none of its own beats by value, by time: interpolated between, in comparison.points.
  std::vector<std::size_t> front;
  std::vector<ComparedCell> atTime;   ///< errors, one per frame time
  std::vector<ComparedCell> atError;  ///< ms, one per error
};

/// From one frame time to another, the points that give the least error within it: the first has the least,
/// the others, one for each further pipeline, cannot be told apart from it. Measured points only.
struct FrameTimeRange {
  double fromMs = 0.0;
  std::optional<double> toMs;  ///< none: for every larger one
  std::vector<std::size_t> best;
};

struct PipelineComparison {
  std::string component;  ///< name(Contributes); "final": the whole image
  bool bias = false;      ///< against the technique's own model; false: against full transport
  std::string reference;  ///< layer that they are judged against
  std::string metric;
  std::vector<ComparedPoint> points;  ///< by time
  std::vector<ComparedPipeline> pipelines;
  std::vector<std::size_t> front;  ///< of all points by value alone: the line that bounds them
  std::vector<double> frameTimesMs, errors;
  std::vector<FrameTimeRange> ranges;
  double timeShare = kSignificantTimeShare;  ///< that times must be apart
  int controls = 0;                          ///< that say so; 0: it is kSignificantTimeShare
  /// Points whose time or error has too few repeats or seeds for a claim: they neither beat nor are beaten.
  std::size_t undecided = 0;
  /// Pipelines that are not among these, and the one that each comes to the same passes as: samePipelines().
  std::map<std::string, std::string> same;
  /// Every pipeline, of two at least, has a point with one and the same error, to the bit: the component
  /// tells nothing apart. Direct light that all pipelines make with the same passes, for instance.
  bool equalForAll = false;

  /// Whether some of its points are on the Pareto front: no other pipeline beats it at their frame times.
  bool hasFront(std::size_t pipeline) const;
};

/// Frame times and errors of the tables. Empty: round numbers between the smallest and the largest measured.
struct ComparisonLimits {
  std::vector<double> frameTimesMs, errors;
  TimeFloor floor = {};  ///< of the device that the points were timed on
};

/// Names of the components that pipelines can be compared in: first those that tell techniques apart, the
/// indirect ones; the last is "final", the whole image.
std::vector<std::string> comparableComponents();
/// Of these, those that some point has an error for.
std::vector<std::string> componentsOf(const std::vector<const ReportPoint*>& points);
/// The error of a component at a point, if it was measured: against the bias reference or the full one (a
/// component with one reference has only the first, which then answers for both). For the component "final"
/// it is that of the whole image.
const ComponentError* componentErrorOf(const ReportPoint& point, const std::string& component, bool bias);
/// The metrics that can be compared: those that are 0 for the reference itself and grow with the error.
std::vector<std::string> errorMetrics();
/// Error names the metrics, and the nearest, when this is none of errorMetrics().
void requireErrorMetric(const std::string& metric);
/// The metric of that name: mean over seeds with the reference's noise and the spread over seeds; NaN: none.
Measured errorNumber(const ComponentError& error, const std::string& metric);

/// Compares the points that were timed and judged in this component; without any of them `points` is empty. A
/// pipeline that comes to the same passes as another one is left out, and named in `same`.
PipelineComparison comparePipelines(const std::vector<const ReportPoint*>& points,
                                    const std::string& component, bool bias, const std::string& metric,
                                    const ComparisonLimits& limits);
/// Every component of a scene, the whole image last, against full transport and, where that is another
/// reference, against the techniques' own model. Without what has no points.
std::vector<PipelineComparison> compareComponents(const std::vector<const ReportPoint*>& points,
                                                  const std::vector<std::string>& metrics,
                                                  const ComparisonLimits& limits);

/// The comparison that a reader is shown first, an index: the indirect component that most pipelines have and
/// that differs between them, against the techniques' own model; where there is none, the whole image, or
/// what there is. Of the metric kDefaultMetric, or of the first one's. Empty: there is nothing to compare.
std::optional<std::size_t> ledComparison(const std::vector<PipelineComparison>& comparisons);

/// Stored runs that can be set against each other: one scene with its content, camera, time, size of the
/// image and positions in the pixel, one device, driver, way of shaders and host, the same outputs kept.
struct ComparableRuns {
  std::string title;  ///< "cornell, camera main, 128x128, on llvmpipe"
  /// The last of each point, and of each pipeline only those with the content of its last run: its text, its
  /// techniques and the framework. Without failed ones.
  std::vector<const StoredRun*> runs;
  std::size_t passedOver = 0;  ///< older ones, and failed ones
};
std::vector<ComparableRuns> comparableRuns(const std::vector<StoredRun>& runs);

nlohmann::ordered_json toJson(const PipelineComparison& comparison);

}  // namespace lumivox
