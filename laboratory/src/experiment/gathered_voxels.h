// Judges the voxels that a point's indirect light is gathered from, apart from its errors and times.
#pragma once

#include <deque>
#include <optional>
#include <string>

#include "experiment/measure.h"
#include "lumivox/measure/voxels.h"
#include "lumivox/results/records.h"

namespace lumivox::experiment {

/// The exact voxels of a scene at one time, and those that rays cross; made once for each grid.
class VoxelReferences {
 public:
  struct InGrid {
    GridPlacement grid;
    VoxelReference voxels;
    RayCrossings crossings;
  };
  /// The scene must outlive this. Camera and size are those of the frames that the grids come from.
  VoxelReferences(const Scene& scene, double time, std::string camera, int width, int height);
  const InGrid& in(const GridPlacement& grid);

 private:
  const Scene* scene_;
  double time_;
  std::string camera_;
  int width_, height_;
  std::deque<InGrid> made_;
};

/// Voxels along the longest side of the largest grid that is judged beside errors. The exact voxels of a
/// larger grid take longer than most points.
inline constexpr int kLargestJudgedGrid = 256;

/// An output of a pass.
struct PassOutput {
  std::string pass, port;
  bool operator==(const PassOutput&) const = default;
};

/// The output with voxels that the indirect outputs of a pipeline on a scene depend on, as it runs there: the
/// list of fragments that the fewest passes lie behind, or without a list the nearest grid that says which of
/// its voxels are occupied. Nothing: they are gathered from no voxels.
std::optional<PassOutput> gatheredVoxelsOf(const TimingContext& context, const Pipeline& pipeline,
                                           const ReportPoint& point);

/// Fills the voxels of a point from a frame that makes nothing else. A failure becomes their `whyNot`.
void judgeVoxels(const TimingContext& context, const Pipeline& pipeline, VoxelReferences& references,
                 ReportPoint& point);

}  // namespace lumivox::experiment
