#include "direction_bins.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lumivox::implicit_visibility {
namespace {

constexpr double kEighth = 0.25 * std::numbers::pi;  // of a turn: half the angle that a face spans

/// Solid angle of the rectangle from (0, 0) to (u, v) of a face at distance 1, with the sign of u v.
double cornerSolidAngle(double u, double v) {
  return std::atan2(u * v, std::sqrt(u * u + v * v + 1.0));
}

}  // namespace

double DirectionBins::border(double i) const {
  const double step = 2.0 * i / side_ - 1.0;
  return mapping_ == BinMapping::even ? std::tan(kEighth * step) : step;
}

double DirectionBins::lineAt(double ratio) const {
  const double step = mapping_ == BinMapping::even ? std::atan(ratio) / kEighth : ratio;
  return 0.5 * (step + 1.0) * side_;
}

std::uint32_t DirectionBins::binOf(const glm::vec3& direction) const {
  const glm::vec3 size = glm::abs(direction);
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const double along = direction[axis];
  const auto line = [&](int component) {
    return std::clamp(static_cast<int>(std::floor(lineAt(direction[component] / along))), 0, side_ - 1);
  };
  const int face = 2 * axis + (along < 0.0 ? 1 : 0);
  return static_cast<std::uint32_t>((face * side_ + line((axis + 2) % 3)) * side_ + line((axis + 1) % 3));
}

glm::vec3 DirectionBins::centre(std::uint32_t bin) const {
  const int face = static_cast<int>(bin / perFace()), within = static_cast<int>(bin % perFace()),
            axis = face / 2;
  glm::dvec3 direction(0.0);
  direction[axis] = 1.0;
  direction[(axis + 1) % 3] = border(within % side_ + 0.5);
  direction[(axis + 2) % 3] = border(within / side_ + 0.5);
  return glm::vec3(glm::normalize(direction) * (face % 2 == 0 ? 1.0 : -1.0));
}

float DirectionBins::solidAngle(std::uint32_t bin) const {
  const int within = static_cast<int>(bin % perFace()), i = within % side_, j = within / side_;
  const double left = border(i), right = border(i + 1), low = border(j), high = border(j + 1);
  return static_cast<float>(cornerSolidAngle(right, high) - cornerSolidAngle(left, high) -
                            cornerSolidAngle(right, low) + cornerSolidAngle(left, low));
}

BinTable::BinTable(const DirectionBins& directions) {
  for (std::uint32_t bin = 0; bin < directions.count(); ++bin)
    bins.emplace_back(directions.centre(bin), directions.solidAngle(bin));
}

float BinTable::projectionScale(const glm::vec3& normal) const {
  double sum = 0.0;
  for (const glm::vec4& bin : bins)
    sum += static_cast<double>(std::max(glm::dot(normal, glm::vec3(bin)), 0.0f) * bin.w);
  return sum > 0.0 ? static_cast<float>(std::numbers::pi / sum) : 0.0f;
}

}  // namespace lumivox::implicit_visibility
