// Finds nearby places by cubic cells in a hash table.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace lumivox::virtual_area_lights {

class NearPlaces {
 public:
  /// The places must outlive this. Cells are `width` m wide.
  NearPlaces(std::span<const glm::vec3> places, float width) : places_(places), inverse_(1.0f / width) {
    buckets_ = std::bit_ceil(static_cast<std::uint32_t>(std::max<std::size_t>(places.size(), 1)));
    first_.assign(std::size_t{buckets_} + 1, 0);
    for (const glm::vec3& place : places) ++first_[bucketOf(cellOf(place)) + 1];
    for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    entries_.resize(places.size());
    for (std::uint32_t i = 0; i < places.size(); ++i) {
      const glm::ivec3 cell = cellOf(places[i]);
      entries_[next[bucketOf(cell)]++] = {cell, i};
    }
  }

  /// Calls `visit(number, squared distance)` once for each place within `radius` of `centre`.
  template <class Visit>
  void within(const glm::vec3& centre, float radius, Visit&& visit) const {
    const auto look = [&](std::uint32_t i) {
      const glm::vec3 path = places_[i] - centre;
      if (const float squared = glm::dot(path, path); squared <= radius * radius) visit(i, squared);
    };
    const float cells = 2.0f * radius * inverse_ + 1.0f;
    if (cells * cells * cells > static_cast<float>(places_.size())) {
      for (std::uint32_t i = 0; i < places_.size(); ++i) look(i);
      return;
    }
    const glm::ivec3 low = cellOf(centre - radius), high = cellOf(centre + radius);
    glm::ivec3 cell;
    for (cell.z = low.z; cell.z <= high.z; ++cell.z)
      for (cell.y = low.y; cell.y <= high.y; ++cell.y)
        for (cell.x = low.x; cell.x <= high.x; ++cell.x) {
          const std::uint32_t bucket = bucketOf(cell);
          for (std::uint32_t e = first_[bucket]; e < first_[bucket + 1]; ++e)
            if (entries_[e].cell == cell) look(entries_[e].place);
        }
  }

 private:
  struct Entry {
    glm::ivec3 cell;
    std::uint32_t place;
  };

  glm::ivec3 cellOf(const glm::vec3& place) const {
    // Beyond this a float resolves only every 128th cell.
    constexpr float kMost = 0x1p30f;
    return glm::ivec3(glm::clamp(glm::floor(place * inverse_), -kMost, kMost));
  }
  std::uint32_t bucketOf(const glm::ivec3& cell) const {
    const glm::uvec3 words(cell);
    return (words.x * 73856093u ^ words.y * 19349663u ^ words.z * 83492791u) & (buckets_ - 1);
  }

  std::span<const glm::vec3> places_;
  float inverse_;
  std::uint32_t buckets_;
  std::vector<std::uint32_t> first_;
  std::vector<Entry> entries_;
};

}  // namespace lumivox::virtual_area_lights
