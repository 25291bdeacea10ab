// One scene's share of a report: the truth, and every point measured for error and, apart from that, for
// time.
#pragma once

#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "report/data.h"

namespace lumivox::report {

/// The truth of a scene with the layers that outputs are judged by, added up once.
class Truth {
 public:
  Truth(const Scene& scene, const ReferenceOptions& options);
  const LayeredPicture& layers() const { return layers_; }
  /// Null when the truth has no such layer.
  const TruthLayer* layer(const std::string& name);
  /// The error of a black picture against it.
  const PictureError& errorOfNothing(const std::string& name);
  /// At which every picture judged against this component's full truth is shown.
  float exposure(const std::string& name);
  double seconds() const { return seconds_; }

 private:
  LayeredPicture layers_;
  std::map<std::string, std::optional<TruthLayer>> cache_;
  std::map<std::string, PictureError> nothing_;
  double seconds_ = 0.0;
};

struct MeasureContext {
  gpu::Device& device;
  TechniqueSource& techniques;
  const Scene& scene;
  const ReportOptions& options;
  Truth& truth;
  int width, height;
};

/// Fills the errors, pictures and health of a point: executors of their own, one per seed.
void measureErrors(const MeasureContext& context, const Pipeline& pipeline, PointRecord& record);
/// One point that is timed frame by frame, so that the frames of several points can take turns: a machine
/// that drifts then biases none of them. No pictures are taken.
class TimedPoint {
 public:
  /// Renders one frame as warm-up: programs are linked, the pool is filled.
  TimedPoint(const MeasureContext& context, const Pipeline& pipeline, ReportPoint& point);
  ~TimedPoint();
  TimedPoint(TimedPoint&&) noexcept;
  void timeFrame();      ///< every kept pass runs
  void timeNextFrame();  ///< 1/60 s after the last one
  void finish();         ///< fills the point's times and bytes

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Times a point alone.
void measureTimes(const MeasureContext& context, const Pipeline& pipeline, PointRecord& record);

/// The truth layers that were used, for the page.
std::vector<TruthRecord> truthRecords(Truth& truth, const std::set<std::string>& used);

}  // namespace lumivox::report
