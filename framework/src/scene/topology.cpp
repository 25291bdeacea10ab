#include "lumivox/scene/topology.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <numeric>
#include <unordered_map>
#include <utility>

namespace lumivox {
namespace {

struct PlaceHash {
  std::size_t operator()(const glm::vec3& place) const {
    std::uint64_t hash = 0;
    for (int axis = 0; axis < 3; ++axis) {
      hash ^= std::bit_cast<std::uint32_t>(place[axis]);
      hash *= 0x9e3779b97f4a7c15ull;
      hash ^= hash >> 29;
    }
    return hash;
  }
};

/// Sets that are merged (Tarjan 1975), to number the components.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parents_(count) {
    std::iota(parents_.begin(), parents_.end(), 0u);
  }
  std::uint32_t find(std::uint32_t item) {
    while (parents_[item] != item) item = parents_[item] = parents_[parents_[item]];
    return item;
  }
  /// The smaller number represents the set.
  void merge(std::uint32_t a, std::uint32_t b) {
    const std::uint32_t rootA = find(a), rootB = find(b);
    parents_[std::max(rootA, rootB)] = std::min(rootA, rootB);
  }

 private:
  std::vector<std::uint32_t> parents_;
};

using Corners = std::array<std::uint32_t, 3>;

Corners cornersOf(const WeldedObject& object, std::size_t triangle) {
  return {object.corners[3 * triangle], object.corners[3 * triangle + 1], object.corners[3 * triangle + 2]};
}

/// Triangles without duplicates of the same orientation.
std::vector<std::uint32_t> distinctTriangles(const WeldedObject& object) {
  std::vector<std::pair<Corners, std::uint32_t>> turned;
  for (std::uint32_t t = 0; t < object.triangleCount(); ++t) {
    Corners corners = cornersOf(object, t);
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    turned.emplace_back(corners, t);
  }
  std::sort(turned.begin(), turned.end());
  std::vector<std::uint32_t> distinct;
  for (std::size_t i = 0; i < turned.size(); ++i)
    if (i == 0 || turned[i].first != turned[i - 1].first) distinct.push_back(turned[i].second);
  std::sort(distinct.begin(), distinct.end());
  return distinct;
}

}  // namespace

WeldedObject weld(const Scene& scene, const Object& object) {
  WeldedObject welded;
  std::unordered_map<glm::vec3, std::uint32_t, PlaceHash> numbers;
  numbers.reserve(object.vertexCount);
  for (const Part& part : object.parts) {
    for (std::uint32_t i = 0; i < part.indexCount; ++i) {
      if (i % 3 == 0) welded.firstIndices.push_back(part.firstIndex + i);
      // Adding zero maps -0 to 0.
      const glm::vec3 place = scene.positions[scene.indices[part.firstIndex + i]] + 0.0f;
      const auto [entry, isNew] = numbers.emplace(place, static_cast<std::uint32_t>(welded.places.size()));
      if (isNew) welded.places.push_back(place);
      welded.corners.push_back(entry->second);
    }
  }
  return welded;
}

std::vector<SurfaceComponent> surfaceComponents(const WeldedObject& object) {
  struct Side {
    std::uint32_t low, high, triangle;
    auto operator<=>(const Side&) const = default;
  };
  const std::vector<std::uint32_t> triangles = distinctTriangles(object);
  std::vector<Side> sides;
  sides.reserve(3 * triangles.size());
  for (const std::uint32_t t : triangles) {
    const Corners corners = cornersOf(object, t);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(corners[k], corners[(k + 1) % 3]);
      if (low != high) sides.push_back({low, high, t});
    }
  }
  std::sort(sides.begin(), sides.end());

  DisjointSets sets(object.triangleCount());
  std::vector<std::uint32_t> openSides;  // a triangle at each open edge
  for (std::size_t first = 0, last = 0; first < sides.size(); first = last) {
    while (last < sides.size() && sides[last].low == sides[first].low &&
           sides[last].high == sides[first].high)
      sets.merge(sides[first].triangle, sides[last++].triangle);
    if ((last - first) % 2 == 1) openSides.push_back(sides[first].triangle);
  }

  std::vector<SurfaceComponent> components;
  std::unordered_map<std::uint32_t, std::size_t> numbers;
  for (const std::uint32_t t : triangles) {
    const auto [entry, isNew] = numbers.emplace(sets.find(t), components.size());
    if (isNew) components.emplace_back();
    SurfaceComponent& component = components[entry->second];
    component.triangles.push_back(t);
    // A sixth of the triple product of its corners: the signed volume that the triangle spans with the
    // component's first corner, which is near and so costs no precision.
    const Corners corners = cornersOf(object, t);
    const glm::dvec3 origin = object.places[object.corners[3 * component.triangles.front()]];
    component.volume += glm::dot(glm::dvec3(object.places[corners[0]]) - origin,
                                 glm::cross(glm::dvec3(object.places[corners[1]]) - origin,
                                            glm::dvec3(object.places[corners[2]]) - origin)) /
                        6.0;
  }
  for (const std::uint32_t t : openSides) ++components[numbers.at(sets.find(t))].openEdges;
  return components;
}

}  // namespace lumivox
