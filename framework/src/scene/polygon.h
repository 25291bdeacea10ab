// Convex polygons in a plane, counter-clockwise.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <vector>

namespace lumivox {

/// The z component of the cross product.
inline double cross(const glm::dvec2& a, const glm::dvec2& b) {
  return a.x * b.y - a.y * b.x;
}

/// The convex hull of points. A corner that spans less than 1e-9 square units with its neighbours is left
/// out, so that rounding adds no corners.
std::vector<glm::dvec2> convexHull(std::vector<glm::dvec2> points);

/// Removes the corners with the least area until `most` are left.
void keepCorners(std::vector<glm::dvec2>& polygon, std::size_t most);

double polygonArea(const std::vector<glm::dvec2>& polygon);

}  // namespace lumivox
