#include "polygon.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace lumivox {

std::vector<glm::dvec2> convexHull(std::vector<glm::dvec2> points) {
  constexpr double kStraight = 1e-9;  // square texels
  // Points of a vertical line must be sorted along it. Rounding in x could swap two of them, and the point
  // between would then look like a concave corner.
  constexpr double kStep = 0x1p-30;  // texels
  for (glm::dvec2& point : points) point = kStep * glm::round(point / kStep);
  std::sort(points.begin(), points.end(), [](const glm::dvec2& a, const glm::dvec2& b) {
    return std::pair(a.x, a.y) < std::pair(b.x, b.y);
  });
  std::vector<glm::dvec2> hull;
  for (const bool back : {false, true}) {
    const std::size_t first = hull.size();
    for (const glm::dvec2& point : points) {
      while (hull.size() >= first + 2 &&
             cross(hull.back() - hull[hull.size() - 2], point - hull.back()) <= kStraight)
        hull.pop_back();
      hull.push_back(point);
    }
    if (!hull.empty()) hull.pop_back();
    if (!back) std::reverse(points.begin(), points.end());
  }
  return hull;
}

void keepCorners(std::vector<glm::dvec2>& polygon, std::size_t most) {
  while (polygon.size() > most) {
    std::size_t least = 0;
    double smallest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const glm::dvec2 &before = polygon[(i + polygon.size() - 1) % polygon.size()],
                       &after = polygon[(i + 1) % polygon.size()];
      if (const double held = cross(polygon[i] - before, after - before); held < smallest)
        smallest = held, least = i;
    }
    polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>(least));
  }
}

double polygonArea(const std::vector<glm::dvec2>& polygon) {
  double doubled = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i)
    doubled += cross(polygon[i] - polygon[0], polygon[(i + 1) % polygon.size()] - polygon[0]);
  return 0.5 * doubled;
}

}  // namespace lumivox
