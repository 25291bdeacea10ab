#include "lumivox/analysis/scaling.h"

#include <cmath>
#include <map>
#include <set>
#include <utility>

namespace lumivox {
namespace {

/// Slope of the least squares line through points of logarithms; nullopt without two different abscissas.
std::optional<double> exponentOf(const std::map<double, double>& timeAt) {
  if (timeAt.size() < 2) return std::nullopt;
  double sumX = 0, sumY = 0, sumXx = 0, sumXy = 0;
  for (const auto& [x, y] : timeAt) {
    const double lx = std::log(x), ly = std::log(y);
    sumX += lx, sumY += ly, sumXx += lx * lx, sumXy += lx * ly;
  }
  const auto n = static_cast<double>(timeAt.size());
  return (n * sumXy - sumX * sumY) / (n * sumXx - sumX * sumX);
}

}  // namespace

std::vector<VoxelizerScaling> scalingOf(const std::vector<VoxelizerRecord>& records) {
  std::vector<VoxelizerScaling> all;
  std::set<std::pair<std::string, std::string>> seen;
  for (const VoxelizerRecord& one : records) {
    if (!one.whyNot.empty() || !seen.insert({one.scene, one.label()}).second) continue;
    std::map<double, double> withResolution, withTriangles;
    for (const VoxelizerRecord& other : records) {
      if (other.scene != one.scene || other.label() != one.label() || !(other.frameMs.median > 0.0)) continue;
      if (other.subdivisions == 0) withResolution[other.resolution] = other.frameMs.median;
      if (other.resolution == one.resolution)
        withTriangles[static_cast<double>(other.triangles)] = other.frameMs.median;
    }
    VoxelizerScaling scaling{one.scene, one.label(), exponentOf(withResolution), exponentOf(withTriangles)};
    if (scaling.withResolution || scaling.withTriangles) all.push_back(std::move(scaling));
  }
  return all;
}

}  // namespace lumivox
