#include "lumivox/results/records.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "lumivox/results/report_record.h"
#include "lumivox/results/voxelizers.h"

namespace lumivox {
namespace {

double saved(const TimingStatistics& pruned, const TimingStatistics& unpruned) {
  return unpruned.median > 0.0 ? 1.0 - pruned.median / unpruned.median : 0.0;
}

}  // namespace

double ComponentError::ratioToNothing() const {
  return errorOfNothing.rmse.value > 0.0 ? error.rmse.value / errorOfNothing.rmse.value
                                         : std::numeric_limits<double>::quiet_NaN();
}

int framesOf(const ParameterValues& parameters) {
  const auto found = parameters.find(kAccumulatedFrames);
  return found == parameters.end() ? 1 : std::max(1, static_cast<int>(found->second.number));
}

CostParts costParts(const ReportPoint& point) {
  // The remainder of the longer time, which noise may make negative.
  const auto left = [](const TimingStatistics& all, const TimingStatistics& part) {
    const Measured a = medianOf(all), b = medianOf(part);
    return Measured{std::max(0.0, a.value - b.value), std::hypot(a.uncertainty, b.uncertainty)};
  };
  constexpr Measured kUnknown{std::numeric_limits<double>::quiet_NaN(), 0.0};
  CostParts parts{kUnknown, kUnknown, kUnknown};
  if (point.stillFrameMs.repeats == 0 || point.movedFrameMs.repeats == 0) return parts;
  parts.everyFrameMs = medianOf(point.stillFrameMs);
  parts.movingMs = left(point.movedFrameMs, point.stillFrameMs);
  if (framesOf(point.parameters) == 1) parts.onceMs = left(point.frameMs, point.movedFrameMs);
  return parts;
}

double PruningRecord::savedShare() const {
  return saved(prunedMs, unprunedMs);
}
double PruningRecord::standingShare() const {
  return saved(nextPrunedMs, prunedMs);
}

double VoxelizerRecord::bytesPerFragment() const {
  return fragments == 0 ? 0.0 : static_cast<double>(bytes) / static_cast<double>(fragments);
}
double VoxelizerRecord::bytesPerVoxel() const {
  return occupied == 0 ? 0.0 : static_cast<double>(bytes) / static_cast<double>(occupied);
}

std::string VoxelizerRecord::label() const {
  std::string text = std::filesystem::path(pipeline).stem().string();
  if (!output.empty()) text += " " + output;
  if (!isDefault)
    for (const auto& [name, value] : parameters)
      if (name != "resolution") text += " " + name + "=" + value.text();
  return text;
}

std::vector<const ReportPoint*> pointsOf(const SceneRecord& scene) {
  std::vector<const ReportPoint*> points;
  for (const PointRecord& record : scene.points) points.push_back(&record.point);
  return points;
}

std::vector<StoredRun> runsOf(const ReportRecord& report, const SceneRecord& scene) {
  std::vector<StoredRun> runs;
  for (const PointRecord& record : scene.points) {
    StoredRun& run = runs.emplace_back();
    run.identity = record.identity;
    for (const auto& [name, value] : record.point.parameters)
      run.identity.parameters.emplace(name,
                                      value.text());  // a point that was not measured has only its parameters
    run.created = record.created;
    run.node = record.node;
    run.seconds = record.seconds;
    run.before = record.before;
    run.after = record.after;
    run.version = LUMIVOX_VERSION;
    run.sceneName = scene.name;
    for (const PipelineRecord& pipeline : report.pipelines)
      if (pipeline.file == record.point.pipeline) run.pipelineName = pipeline.name;
    run.isDefault = record.isDefault;
    run.point = record.point;
  }
  return runs;
}

}  // namespace lumivox
