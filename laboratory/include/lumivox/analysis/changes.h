// Significant changes between two sets of stored results.
#pragma once

#include <string>
#include <vector>

#include "lumivox/analysis/interpolation.h"
#include "lumivox/results/runs.h"

namespace lumivox {

struct RunChange {
  std::string point;     ///< "cornell, voxel_cone_tracing: cones=6 resolution=64"
  std::string quantity;  ///< "frame ms", "indirect_diffuse rmse against one_bounce_diffuse", ...
  Measured before, after;
  double sigmas = 0.0;  ///< difference over its standard uncertainty; infinite when that is 0
  bool significant = false, better = false;
  /// Fewer than kLeastRepeats repeats or seeds on one side, or metrics of the first seed alone: no claim.
  bool undecided = false;
};

struct RunComparison {
  std::size_t compared = 0;  ///< points that both have
  std::vector<RunChange> changes;
  std::vector<std::string> onlyBefore, onlyAfter;
  /// Points of the same name that measure different things: "cornell, ...: other size", with the reason.
  std::vector<std::string> incomparable;
};

/// Matches points by scene, pipeline, parameters, camera, time and seed, the last stored of each. Two runs
/// alone are compared whatever they measure. Times of different devices or hosts are not compared; errors of
/// different sizes or other scenes are not. Times must be further apart than kSignificantTimeShare and than
/// `floor`.
RunComparison compareResults(const std::vector<StoredRun>& before, const std::vector<StoredRun>& after,
                             const TimeFloor& floor = {});

}  // namespace lumivox
