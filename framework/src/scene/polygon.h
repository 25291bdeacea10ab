// Convex polygons in a plane, counter-clockwise.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <vector>

namespace lumivox {

/// Along the third axis.
inline double cross(const glm::dvec2& a, const glm::dvec2& b) {
  return a.x * b.y - a.y * b.x;
}

/// The convex hull of points. A corner that stands out by less than 1e-9 square units of its neighbours' line
/// is left out, so that rounding adds none.
std::vector<glm::dvec2> convexHull(std::vector<glm::dvec2> points);

/// Leaves out the corners that hold the least area until so many are left.
void keepCorners(std::vector<glm::dvec2>& polygon, std::size_t most);

double polygonArea(const std::vector<glm::dvec2>& polygon);

}  // namespace lumivox
