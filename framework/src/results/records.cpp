#include "lumivox/results/records.h"

#include <filesystem>

#include "lumivox/results/report_record.h"
#include "lumivox/results/voxelisers.h"

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

double PruningRecord::savedShare() const {
  return saved(prunedMs, unprunedMs);
}
double PruningRecord::savedShareNext() const {
  return saved(nextPrunedMs, nextUnprunedMs);
}

double VoxeliserRecord::bytesPerFragment() const {
  return fragments == 0 ? 0.0 : static_cast<double>(bytes) / static_cast<double>(fragments);
}
double VoxeliserRecord::bytesPerVoxel() const {
  return occupied == 0 ? 0.0 : static_cast<double>(bytes) / static_cast<double>(occupied);
}

std::string VoxeliserRecord::label() const {
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

}  // namespace lumivox
