// One scene's share of a report: the truth, and every point measured for error and, apart from that, for
// time.
#pragma once

#include <map>
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
/// Fills its times and bytes: no pictures are taken in the timed frames.
void measureTimes(const MeasureContext& context, const Pipeline& pipeline, PointRecord& record);

/// The truth layers that were used, for the page.
std::vector<TruthRecord> truthRecords(Truth& truth, const std::set<std::string>& used);

}  // namespace lumivox::report
