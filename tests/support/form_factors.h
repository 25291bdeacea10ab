// Form factors in closed form.
#pragma once

#include <cmath>
#include <vector>

#include "support/scene_builder.h"

namespace lumivox::test {

/// The form factor from a point with a normal to a polygon in front of it (Lambert 1760): the sum over the
/// edges of the angle that an edge subtends, times the cosine between the normal and that of the angle's
/// plane, divided by 2 pi.
inline double polygonFormFactor(const glm::dvec3& point, const glm::dvec3& normal,
                                const std::vector<glm::dvec3>& corners) {
  double sum = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::dvec3 a = glm::normalize(corners[i] - point),
                     b = glm::normalize(corners[(i + 1) % corners.size()] - point), across = glm::cross(a, b);
    sum += std::atan2(glm::length(across), glm::dot(a, b)) * glm::dot(glm::normalize(across), normal);
  }
  return std::abs(sum) / (2.0 * kPi);
}

/// From a floor point to a square of half side a, centred 1 m above it.
inline double squareAbove(double a) {
  return polygonFormFactor({0, 0, 0}, {0, 1, 0}, {{-a, 1, -a}, {a, 1, -a}, {a, 1, a}, {-a, 1, a}});
}

}  // namespace lumivox::test
