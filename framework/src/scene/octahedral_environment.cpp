#include "scene/octahedral_environment.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace lumivox {
namespace {

std::size_t texelTowards(const glm::vec3& d, int side) {
  glm::vec2 place = glm::vec2(d) / (std::abs(d.x) + std::abs(d.y) + std::abs(d.z));
  if (d.z < 0.0f)
    place = glm::vec2(std::copysign(1.0f - std::abs(place.y), place.x),
                      std::copysign(1.0f - std::abs(place.x), place.y));
  const auto within = [side](float value) {
    return static_cast<std::size_t>(
        std::clamp(static_cast<int>((0.5f * value + 0.5f) * static_cast<float>(side)), 0, side - 1));
  };
  return within(place.y) * static_cast<std::size_t>(side) + within(place.x);
}

/// Of the texels of one level.
struct Sums {
  std::vector<glm::dvec3> radiance;  ///< times solid angle
  std::vector<double> solidAngle;
  explicit Sums(int side)
      : radiance(static_cast<std::size_t>(side) * static_cast<std::size_t>(side)),
        solidAngle(radiance.size()) {}
};

/// Sums over the parts of the map's texels, each cut so finely that a texel of the octahedron has several.
Sums finest(const EnvironmentMap& map, int side) {
  constexpr int kPartsAcross = 4;  // of a texel of the octahedron
  Sums sums(side);
  const auto cut = [&](int texels) { return std::max(1, (kPartsAcross * side + texels - 1) / texels); };
  const int across = cut(std::max(1, map.width / 2)), down = cut(map.height), parts = across * down;
  const glm::vec3* texel = map.radiance.data();
  for (int row = 0; row < map.height; ++row) {
    const double solidAngle = map.solidAngle(row) / parts;
    for (int column = 0; column < map.width; ++column, ++texel) {
      const glm::dvec3 light = solidAngle * glm::dvec3(*texel);
      for (int part = 0; part < parts; ++part) {
        const float u = (static_cast<float>(part % across) + 0.5f) / static_cast<float>(across),
                    v = (static_cast<float>(part / across) + 0.5f) / static_cast<float>(down);
        const std::size_t to = texelTowards(map.directionWithin(column, row, u, v), side);
        sums.radiance[to] += light;
        sums.solidAngle[to] += solidAngle;
      }
    }
  }
  return sums;
}

Sums halved(const Sums& finer, int side) {
  Sums sums(side);
  const auto n = static_cast<std::size_t>(side);
  for (std::size_t y = 0; y < 2 * n; ++y) {
    for (std::size_t x = 0; x < 2 * n; ++x) {
      sums.radiance[y / 2 * n + x / 2] += finer.radiance[y * 2 * n + x];
      sums.solidAngle[y / 2 * n + x / 2] += finer.solidAngle[y * 2 * n + x];
    }
  }
  return sums;
}

}  // namespace

OctahedralEnvironment::OctahedralEnvironment(const EnvironmentMap& map)
    : side_(map.radiance.size() == 1 ? 1
                                     : static_cast<int>(std::bit_ceil(
                                           static_cast<unsigned>(std::clamp(map.height, 2, kLargestSide))))),
      levels_(std::bit_width(static_cast<unsigned>(side_))) {
  if (side_ == 1) {  // to the bit, which sums of products do not promise
    radiance_ = map.radiance;
    return;
  }
  Sums sums = finest(map, side_);
  for (int side = side_;; side /= 2) {
    for (std::size_t i = 0; i < sums.radiance.size(); ++i)
      radiance_.push_back(glm::vec3(sums.radiance[i] / std::max(sums.solidAngle[i], 1e-300)));
    if (side == 1) break;
    sums = halved(sums, side / 2);
  }
}

}  // namespace lumivox
