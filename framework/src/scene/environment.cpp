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

void EnvironmentMap::finish() {
  brightest = glm::vec3(0.0f);
  for (const glm::vec3& texel : radiance) brightest = glm::max(brightest, texel);
  Hasher hasher;
  hasher.add(width).add(height).add(radiance);
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row) hasher.add(toMap[column][row]);
  hash = hasher.finish();
}

std::size_t EnvironmentMap::texelTowards(const glm::vec3& direction) const {
  const glm::vec3 d = toMap * direction;
  const float u = 0.5f + std::atan2(d.x, -d.z) * static_cast<float>(0.5 / kPi);
  const float v = std::atan2(std::sqrt(d.x * d.x + d.z * d.z), d.y) * static_cast<float>(1.0 / kPi);
  return interval(v, height) * static_cast<std::size_t>(width) + interval(u, width);
}

glm::vec3 EnvironmentMap::direction(float column, float row) const {
  const double azimuth = 2.0 * kPi * (column / width - 0.5), polar = kPi * row / height;
  return glm::transpose(toMap) * glm::vec3(std::sin(polar) * std::sin(azimuth), std::cos(polar),
                                           -std::sin(polar) * std::cos(azimuth));
}

glm::vec3 EnvironmentMap::directionWithin(int column, int row, float u, float v) const {
  // Equal steps of height on the unit sphere have equal areas. From the half-angle's sine, so that texels at
  // a pole lose no digits: 1 - cos = 2 sin^2.
  const double top = std::sin(0.5 * kPi * row / height), bottom = std::sin(0.5 * kPi * (row + 1) / height);
  const double halfSquared = top * top + v * (bottom * bottom - top * top);
  const double up = 1.0 - 2.0 * halfSquared, side = 2.0 * std::sqrt(halfSquared * (1.0 - halfSquared));
  const double azimuth = 2.0 * kPi * ((column + static_cast<double>(u)) / width - 0.5);
  return glm::transpose(toMap) * glm::vec3(side * std::sin(azimuth), up, -side * std::cos(azimuth));
}

double EnvironmentMap::solidAngle(int row) const {
  // cos a - cos b as a product, which keeps its digits at the poles.
  return 2.0 * kPi / width * 2.0 * std::sin(0.5 * kPi * (2 * row + 1) / height) *
         std::sin(0.5 * kPi / height);
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
