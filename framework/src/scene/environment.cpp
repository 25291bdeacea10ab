#include "lumivox/scene/environment.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lumivox {
namespace {

constexpr double kPi = std::numbers::pi;

/// The number of the interval of [0, 1) that holds the value, out of `count`.
std::size_t interval(float value, int count) {
  return static_cast<std::size_t>(
      std::clamp(static_cast<int>(value * static_cast<float>(count)), 0, count - 1));
}

}  // namespace

std::size_t EnvironmentMap::texelTowards(const glm::vec3& direction) const {
  const glm::vec3 d = toMap * direction;
  const float u = 0.5f + std::atan2(d.x, -d.z) * static_cast<float>(0.5 / kPi);
  const float v = std::atan2(std::sqrt(d.x * d.x + d.z * d.z), d.y) * static_cast<float>(1.0 / kPi);
  return interval(v, height) * static_cast<std::size_t>(width) + interval(u, width);
}

glm::vec3 EnvironmentMap::direction(float column, float row) const {
  const double azimuth = 2.0 * kPi * (column / width - 0.5), polar = kPi * row / height;
  const glm::dvec3 inMap(std::sin(polar) * std::sin(azimuth), std::cos(polar),
                         -std::sin(polar) * std::cos(azimuth));
  return glm::vec3(glm::transpose(glm::dmat3(toMap)) * inMap);
}

double EnvironmentMap::solidAngle(int row) const {
  return 2.0 * kPi / width * (std::cos(kPi * row / height) - std::cos(kPi * (row + 1) / height));
}

glm::vec3 EnvironmentMap::mean() const {
  glm::dvec3 sum(0.0);
  for (int row = 0; row < height; ++row) {
    glm::dvec3 ofRow(0.0);
    const glm::vec3* texel = &radiance[static_cast<std::size_t>(row) * static_cast<std::size_t>(width)];
    for (int column = 0; column < width; ++column) ofRow += glm::dvec3(texel[column]);
    sum += solidAngle(row) * ofRow;
  }
  return glm::vec3(sum / (4.0 * kPi));
}

}  // namespace lumivox
