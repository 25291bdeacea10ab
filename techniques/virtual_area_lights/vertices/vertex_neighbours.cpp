#include "vertex_neighbours.h"

#include <algorithm>
#include <glm/gtc/matrix_inverse.hpp>
#include <limits>
#include <utility>

#include "lumivox/scene/models.h"

namespace lumivox::virtual_area_lights {
namespace {

/// Vertices at rest, relative to one of them, which keeps precision far from the origin.
class AtRest {
 public:
  explicit AtRest(const Scene& scene) : scene_(scene) {
    for (const Object& object : scene.objects)
      turns_.emplace_back(glm::inverseTranspose(glm::dmat3(object.placement)));
    if (!scene.positions.empty())
      origin_ = glm::dvec3(scene.objects.front().placement * glm::dvec4(scene.positions.front(), 1.0));
  }
  glm::vec3 position(std::size_t object, std::uint32_t vertex) const {
    const glm::dmat4& placement = scene_.objects[object].placement;
    return glm::vec3(glm::dvec3(placement * glm::dvec4(scene_.positions[vertex], 1.0)) - origin_);
  }
  glm::vec3 normal(std::size_t object, std::uint32_t vertex) const {
    const glm::dvec3 normal = turns_[object] * glm::dvec3(scene_.normals[vertex]);
    return glm::dot(normal, normal) > 0.0 ? glm::vec3(glm::normalize(normal)) : glm::vec3(0.0f);
  }
  SurfacePointState stateOf(const SurfacePointSet& set) const {
    SurfacePointState state;
    for (const SurfacePoint& point : set.points) {
      const std::uint32_t* corners = &scene_.indices[3 * std::size_t{point.place.triangle}];
      const auto mixed = [&](auto&& of) {
        return (1.0f - point.place.second - point.place.third) * of(corners[0]) +
               point.place.second * of(corners[1]) + point.place.third * of(corners[2]);
      };
      state.position.push_back(mixed([&](std::uint32_t vertex) { return position(point.object, vertex); }));
      const glm::vec3 front = mixed([&](std::uint32_t vertex) { return normal(point.object, vertex); });
      state.normal.push_back(point.back ? -front : front);
      state.area.push_back(point.area);
      state.radius.push_back(point.radius);
      state.reach.push_back(point.reach);
    }
    return state;
  }

 private:
  const Scene& scene_;
  std::vector<glm::dmat3> turns_;
  glm::dvec3 origin_{0.0};
};

/// Keeps the nearest of the offered points by increasing distance; among equals the first stays.
class NearestList {
 public:
  explicit NearestList(int most) : most_(static_cast<std::size_t>(most)) {}
  void clear() {
    found_.clear();
    farthest_ = std::numeric_limits<float>::max();
  }
  bool takes(float distanceSquared) const { return distanceSquared < farthest_; }
  void take(float distanceSquared, std::uint32_t point) {
    if (found_.size() == most_) found_.pop_back();
    const auto behind = [](float value, const auto& entry) { return value < entry.first; };
    found_.insert(std::upper_bound(found_.begin(), found_.end(), distanceSquared, behind),
                  {distanceSquared, point});
    if (found_.size() == most_) farthest_ = found_.back().first;
  }
  /// Without points beyond `farthest`, unless there is only one. `to` has room for all.
  void write(std::uint32_t* to, double farthest) const {
    for (std::size_t i = 0; i < found_.size(); ++i)
      if (i == 0 || static_cast<double>(found_[i].first) <= farthest * farthest) to[i] = found_[i].second;
  }

 private:
  std::size_t most_;
  float farthest_ = std::numeric_limits<float>::max();
  std::vector<std::pair<float, std::uint32_t>> found_;
};

/// The lists of one side of a vertex.
struct SideLists {
  NearestList any, glossy;
};

/// The material of every vertex, -1 without a triangle. A vertex shared by parts has the first glossy
/// material, since it has one glossy light.
std::vector<int> materialsOfVertices(const Scene& scene) {
  std::vector<int> materials(scene.positions.size(), -1);
  for (const Object& object : scene.objects)
    for (const Part& part : object.parts)
      for (std::uint32_t i = part.firstIndex; i < part.firstIndex + part.indexCount; ++i) {
        int& material = materials[scene.indices[i]];
        if (material < 0 || !scene.materials[static_cast<std::size_t>(material)].glossy())
          material = part.material;
      }
  return materials;
}

}  // namespace

VertexNeighbours neighboursOfVertices(const Scene& scene, const SurfacePointSet& set, int neighbours) {
  VertexNeighbours result;
  result.sides = std::ranges::any_of(set.points, &SurfacePoint::back) ? 2 : 1;
  const AtRest rest(scene);
  const SurfacePointState state = rest.stateOf(set);
  const SurfacePointGrid grid = gridOf(set, state);
  const std::vector<std::uint32_t> models = modelsOf(scene);
  const std::vector<int> materials = materialsOfVertices(scene);
  const auto materialOf = [&](int index) -> const Material& {
    return scene.materials[static_cast<std::size_t>(index)];
  };
  const auto cellAt = [&](const glm::vec3& place) {
    const GridPlacement& placement = grid.placement;
    const glm::ivec3 cell = glm::clamp(glm::ivec3(glm::floor((place - placement.low) / placement.voxelSize)),
                                       glm::ivec3(0), placement.resolution - 1);
    return static_cast<std::size_t>(cell.x +
                                    placement.resolution.x * (cell.y + placement.resolution.y * cell.z));
  };
  // Vertices of parts that the scene leaves out belong to no object.
  const std::size_t entries = scene.positions.size() * static_cast<std::size_t>(result.sides * neighbours);
  result.any.assign(entries, VertexNeighbours::kNone);
  result.glossy.assign(entries, VertexNeighbours::kNone);
  std::vector<SideLists> sides(static_cast<std::size_t>(result.sides),
                               {NearestList(neighbours), NearestList(neighbours)});
  for (std::size_t o = 0; o < scene.objects.size(); ++o) {
    const Object& object = scene.objects[o];
    for (std::uint32_t vertex = object.firstVertex; vertex < object.firstVertex + object.vertexCount;
         ++vertex) {
      const glm::vec3 position = rest.position(o, vertex), normal = rest.normal(o, vertex);
      const int material = materials[vertex];
      const bool isGlossy = material >= 0 && materialOf(material).glossy();
      for (SideLists& side : sides) side.any.clear(), side.glossy.clear();
      const std::size_t cell = cellAt(position);
      for (std::uint32_t i = grid.first[cell]; i < grid.first[cell + 1]; ++i) {
        const std::uint32_t index = grid.points[i];
        const glm::vec3 path = state.position[index] - position;
        const float distanceSquared = glm::dot(path, path);
        float cosine = glm::dot(normal, state.normal[index]);
        for (SideLists& side : sides) {
          const bool isNear = side.any.takes(distanceSquared),
                     mayShine = isGlossy && side.glossy.takes(distanceSquared);
          const bool isOther = cosine < kOtherSideCosine;
          cosine = -cosine;
          if (!(isNear || mayShine) || isOther || set.points[index].model != models[o]) continue;
          if (isNear) side.any.take(distanceSquared, index);
          const Material& of = materialOf(set.points[index].material);
          if (mayShine && of.glossy() && of.exponent == materialOf(material).exponent)
            side.glossy.take(distanceSquared, index);
        }
      }
      std::size_t at = std::size_t{vertex} * static_cast<std::size_t>(result.sides * neighbours);
      for (const SideLists& side : sides) {
        side.any.write(&result.any[at], set.farthest);
        side.glossy.write(&result.glossy[at], set.farthest);
        at += static_cast<std::size_t>(neighbours);
      }
    }
  }
  return result;
}

}  // namespace lumivox::virtual_area_lights
