#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "surface_points.h"

namespace lumivox::virtual_area_lights {
namespace {

/// An object's vertices at a time.
class MovedObject {
 public:
  MovedObject(const Scene& scene, const SceneSnapshot& snapshot, std::size_t object)
      : scene_(&scene), state_(&snapshot.objects[object]), object_(&scene.objects[object]) {}

  /// Whether triangles may stretch: they deform, or their node may be scaled.
  bool deforms() const { return object_->sequence.has_value() || object_->animation != nullptr; }
  std::array<glm::vec3, 3> corners(const SurfacePlace& place) const {
    return eachCorner(place, [&](std::uint32_t vertex) {
      return glm::vec3(state_->toWorld * glm::vec4(localPosition(vertex), 1.0f));
    });
  }
  std::array<glm::vec3, 3> cornersAtRest(const SurfacePlace& place) const {
    return eachCorner(place, [&](std::uint32_t vertex) {
      return glm::vec3(glm::dmat3(object_->placement) * glm::dvec3(scene_->positions[vertex]));
    });
  }
  /// Vector along the front side's normal.
  static glm::vec3 frontOf(const std::array<glm::vec3, 3>& corners) {
    return glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
  }
  /// The interpolated normal, not of unit length.
  glm::vec3 shadingNormal(const SurfacePlace& place) const {
    const auto normals = eachCorner(place, [&](std::uint32_t vertex) {
      const glm::vec3& local =
          state_->normals.empty() ? scene_->normals[vertex] : state_->normals[vertex - object_->firstVertex];
      return state_->normalToWorld * local;
    });
    return (1.0f - place.second - place.third) * normals[0] + place.second * normals[1] +
           place.third * normals[2];
  }

 private:
  template <class Value>
  std::array<glm::vec3, 3> eachCorner(const SurfacePlace& place, Value&& value) const {
    const std::uint32_t* at = &scene_->indices[3 * std::size_t{place.triangle}];
    return {value(at[0]), value(at[1]), value(at[2])};
  }
  const glm::vec3& localPosition(std::uint32_t vertex) const {
    return state_->positions.empty() ? scene_->positions[vertex]
                                     : state_->positions[vertex - object_->firstVertex];
  }

  const Scene* scene_;
  const ObjectState* state_;
  const Object* object_;
};

/// The largest growth of lengths in a triangle, and the growth of its area.
struct Stretch {
  float length = 1.0f, area = 1.0f;
  Stretch() = default;
  Stretch(const std::array<glm::vec3, 3>& rest, const std::array<glm::vec3, 3>& now) {
    const Sides before(rest), after(now);
    const double was = before.determinant();
    if (!(was > 0.0)) return;
    const double squared = after.determinant() / was;
    // The larger eigenvalue of the matrix that maps squared lengths at rest to those of now.
    const double half =
        0.5 * (before.second * after.first - 2.0 * before.mixed * after.mixed + before.first * after.second) /
        was;
    length = static_cast<float>(std::sqrt(half + std::sqrt(std::max(half * half - squared, 0.0))));
    area = static_cast<float>(std::sqrt(squared));
  }

 private:
  /// Products of two sides of a triangle with themselves and each other.
  struct Sides {
    double first, second, mixed;
    explicit Sides(const std::array<glm::vec3, 3>& of) {
      const glm::dvec3 one(of[1] - of[0]), other(of[2] - of[0]);
      first = glm::dot(one, one), second = glm::dot(other, other), mixed = glm::dot(one, other);
    }
    double determinant() const { return std::max(first * second - mixed * mixed, 0.0); }
  };
};

}  // namespace

SurfacePointState stateOf(const SurfacePointSet& set, const Scene& scene, const SceneSnapshot& snapshot) {
  std::vector<MovedObject> objects;
  for (std::size_t o = 0; o < scene.objects.size(); ++o) objects.emplace_back(scene, snapshot, o);
  SurfacePointState state;
  for (const SurfacePoint& point : set.points) {
    const MovedObject& object = objects[point.object];
    const std::array<glm::vec3, 3> corners = object.corners(point.place);
    const auto& [a, b, c] = corners;
    state.position.push_back(a + point.place.second * (b - a) + point.place.third * (c - a));
    glm::vec3 normal = object.shadingNormal(point.place);
    const glm::vec3 front = object.frontOf(corners);
    const float size = glm::length(front);
    const bool isThere = size > 0.0f;
    if (!(glm::length(normal) > 0.0f)) normal = front;
    if (glm::dot(normal, front) < 0.0f) normal = -normal;
    normal = isThere ? glm::normalize(normal) : glm::vec3(0.0f);
    state.normal.push_back(point.back ? -normal : normal);
    const Stretch stretch =
        object.deforms() ? Stretch(object.cornersAtRest(point.place), corners) : Stretch();
    state.area.push_back(isThere ? point.area * stretch.area : 0.0f);
    state.radius.push_back(isThere ? point.radius * stretch.length : 0.0f);
    state.reach.push_back(isThere ? point.reach * stretch.length : 0.0f);
  }
  return state;
}

namespace {

/// Calls `visit(index of a cell)` for the cells that a point's reach touches.
template <class Visit>
void forEachCell(const GridPlacement& grid, const glm::vec3& position, float reach, Visit&& visit) {
  const glm::vec3 centre = (position - grid.low) / grid.voxelSize;
  const float radius = reach / grid.voxelSize;
  const auto cellOf = [](const glm::vec3& place, const glm::ivec3& resolution) {
    return glm::ivec3(glm::clamp(glm::floor(place), glm::vec3(0.0f), glm::vec3(resolution - 1)));
  };
  const glm::ivec3 low = cellOf(centre - radius, grid.resolution),
                   high = cellOf(centre + radius, grid.resolution);
  // Distance from the point to the nearest place of a cell along an axis.
  const auto away = [](float at, int cell) {
    const auto side = static_cast<float>(cell);
    return std::max({side - at, at - side - 1.0f, 0.0f});
  };
  for (int z = low.z; z <= high.z; ++z)
    for (int y = low.y; y <= high.y; ++y) {
      const float z2 = away(centre.z, z), y2 = away(centre.y, y);
      const float rest = radius * radius - z2 * z2 - y2 * y2;
      if (rest < 0.0f) continue;
      const float half = std::sqrt(rest);
      const int first = cellOf(centre - half, grid.resolution).x,
                last = cellOf(centre + half, grid.resolution).x;
      const auto row =
          static_cast<std::size_t>(z * grid.resolution.y + y) * static_cast<std::size_t>(grid.resolution.x);
      for (int x = first; x <= last; ++x) visit(row + static_cast<std::size_t>(x));
    }
}

/// Cells about as wide as points are apart, and wider where lists would become long.
GridPlacement placementOf(const SurfacePointSet& set, const SurfacePointState& state) {
  Bounds bounds;
  for (std::size_t i = 0; i < state.position.size(); ++i) {
    bounds.grow(state.position[i] - state.radius[i]);
    bounds.grow(state.position[i] + state.radius[i]);
  }
  const glm::dvec3 extent(bounds.high - bounds.low);
  const auto cellsOf = [&](double size) { return glm::floor(extent / size) + 1.0; };
  const auto entries = [&](double size) {
    double sum = 0.0;
    const glm::dvec3 cells = cellsOf(size);
    for (const float reach : state.reach) {
      // A ball at a random place touches on average as many cells as the volume of a cell grown by the ball,
      // in cells.
      const double radius = static_cast<double>(reach) / size;
      const double touched = 1.0 + radius * (6.0 + std::numbers::pi * radius * (3.0 + 4.0 / 3.0 * radius));
      const glm::dvec3 along = glm::min(glm::dvec3(2.0 * radius + 1.0), cells);
      sum += std::min(touched, along.x * along.y * along.z);
    }
    return sum;
  };
  double size = set.spacing();
  const double longest = std::max({extent.x, extent.y, extent.z});
  // Rounding loses a cell's border below a hundred thousandth of the whole.
  size = std::max(size, 1e-5 * longest);
  const auto most = [](std::uint64_t number) { return static_cast<double>(number); };
  for (;; size *= 1.1) {
    const glm::dvec3 cells = cellsOf(size);
    const double all = cells.x * cells.y * cells.z;
    if (all <= 1.0 || (all < most(SurfacePointGrid::mostCells(state.position.size())) &&
                       entries(size) <= most(SurfacePointGrid::mostEntries(state.position.size()))))
      break;
  }
  return {bounds.low, static_cast<float>(size), glm::ivec3(cellsOf(size))};
}

}  // namespace

SurfacePointGrid gridOf(const SurfacePointSet& set, const SurfacePointState& state) {
  SurfacePointGrid grid;
  if (set.points.empty()) {
    grid.placement.resolution = glm::ivec3(1);
    grid.first.assign(2, 0);
    return grid;
  }
  grid.placement = placementOf(set, state);
  grid.first.assign(grid.placement.voxelCount() + 1, 0);
  const auto forEachEntry = [&](auto&& visit) {
    for (std::uint32_t i = 0; i < state.position.size(); ++i)
      if (state.area[i] > 0.0f)
        forEachCell(grid.placement, state.position[i], state.reach[i],
                    [&](std::size_t cell) { visit(cell, i); });
  };
  forEachEntry([&](std::size_t cell, std::uint32_t) { ++grid.first[cell + 1]; });
  for (std::size_t cell = 1; cell < grid.first.size(); ++cell) grid.first[cell] += grid.first[cell - 1];
  grid.points.resize(grid.first.back());
  std::vector<std::uint32_t> next(grid.first.begin(), grid.first.end() - 1);
  forEachEntry([&](std::size_t cell, std::uint32_t point) { grid.points[next[cell]++] = point; });
  return grid;
}

}  // namespace lumivox::virtual_area_lights
