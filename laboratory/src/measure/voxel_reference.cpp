// Finds exactly which voxels triangles touch.
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "lumivox/measure/voxels.h"
#include "measure/voxel_mask.h"

namespace lumivox {

TriangleBoxTest::TriangleBoxTest(const ExactTriangle& triangle)
    : low_(glm::min(triangle[0], glm::min(triangle[1], triangle[2]))),
      high_(glm::max(triangle[0], glm::max(triangle[1], triangle[2]))) {
  const std::array<glm::dvec3, 3> edges{triangle[1] - triangle[0], triangle[2] - triangle[1],
                                        triangle[0] - triangle[2]};
  std::size_t next = 0;
  // Axes of length zero, as of a point or line, separate nothing; the other axes decide.
  const auto add = [&](const glm::dvec3& direction) {
    const double a = glm::dot(direction, triangle[0]), b = glm::dot(direction, triangle[1]),
                 c = glm::dot(direction, triangle[2]);
    axes_[next++] = {direction, glm::abs(direction), std::min({a, b, c}), std::max({a, b, c})};
  };
  add(glm::cross(edges[0], edges[1]));
  for (const glm::dvec3& edge : edges) {
    add({0.0, -edge.z, edge.y});
    add({edge.z, 0.0, -edge.x});
    add({-edge.y, edge.x, 0.0});
  }
}

bool TriangleBoxTest::overlaps(const glm::dvec3& boxCentre, const glm::dvec3& boxHalfExtent) const {
  if (glm::any(glm::greaterThan(low_, boxCentre + boxHalfExtent)) ||
      glm::any(glm::lessThan(high_, boxCentre - boxHalfExtent)))
    return false;
  for (const Axis& axis : axes_) {
    const double centre = glm::dot(axis.direction, boxCentre),
                 reach = glm::dot(axis.magnitude, boxHalfExtent);
    if (axis.low > centre + reach || axis.high < centre - reach) return false;
  }
  return true;
}

namespace {

/// Whether a triangle has surface in a voxel.
enum class Solid { no, perhaps, yes };
using SolidIn = std::function<Solid(const glm::ivec3& voxel)>;

/// Marks the voxels of one triangle. Boxes of voxels that the triangle misses are dropped as a whole.
class Marker {
 public:
  Marker(VoxelReference& reference, double tolerance) : reference_(reference), tolerance_(tolerance) {}

  /// `solid` may be empty: then the whole triangle is solid.
  void mark(const ExactTriangle& triangle, const SolidIn& solid) const {
    for (const glm::dvec3& corner : triangle)
      if (!std::isfinite(corner.x) || !std::isfinite(corner.y) || !std::isfinite(corner.z)) return;
    const TriangleBoxTest test(triangle);
    const glm::dvec3 side(reference_.possible.resolution());
    const glm::dvec3 low = test.low() - tolerance_, high = test.high() + tolerance_;
    if (glm::any(glm::lessThan(high, glm::dvec3(0.0))) || glm::any(glm::greaterThan(low, side))) return;
    // A contact on the face between two voxels belongs to both.
    const glm::ivec3 first(glm::max(glm::ceil(low) - 1.0, 0.0));
    const glm::ivec3 end(glm::min(glm::floor(high) + 1.0, side));
    if (glm::all(glm::lessThan(first, end))) visit(test, solid, first, end);
  }

 private:
  void visit(const TriangleBoxTest& test, const SolidIn& solid, const glm::ivec3& first,
             const glm::ivec3& end) const {
    const glm::dvec3 half = 0.5 * glm::dvec3(end - first), centre = glm::dvec3(first) + half;
    if (!test.overlaps(centre, half + tolerance_)) return;
    const glm::ivec3 size = end - first;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    if (size[axis] > 1) {
      glm::ivec3 middle = end;
      middle[axis] = first[axis] + size[axis] / 2;
      visit(test, solid, first, middle);
      middle = first;
      middle[axis] += size[axis] / 2;
      visit(test, solid, middle, end);
      return;
    }
    const Solid there = solid ? solid(first) : Solid::yes;
    if (there == Solid::no) return;
    reference_.possible.insertShared(first);
    if (there == Solid::yes && test.overlaps(centre, half - tolerance_))
      reference_.certain.insertShared(first);
  }

  VoxelReference& reference_;
  double tolerance_;
};

constexpr std::size_t kGrain = 256;  // triangles that one task takes at a time

}  // namespace

VoxelReference trueVoxels(std::span<const ExactTriangle> triangles, const glm::ivec3& resolution,
                          double tolerance) {
  VoxelReference reference{VoxelSet(resolution), VoxelSet(resolution)};
  const Marker marker(reference, tolerance);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, triangles.size(), kGrain), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) marker.mark(triangles[i], {});
  });
  return reference;
}

VoxelReference trueVoxels(const Scene& scene, const SceneSnapshot& snapshot, const GridPlacement& grid,
                          double tolerance) {
  VoxelReference reference{VoxelSet(grid.resolution), VoxelSet(grid.resolution)};
  const Marker marker(reference, tolerance);
  const glm::dvec3 gridLow(grid.low);
  const auto voxelSize = static_cast<double>(grid.voxelSize);
  for (std::size_t o = 0; o < scene.objects.size(); ++o) {
    const Object& object = scene.objects[o];
    const ObjectState& state = snapshot.objects[o];
    const glm::dmat4 toWorld(state.toWorld);
    const auto corner = [&](std::uint32_t index) {
      const glm::vec3& local =
          state.positions.empty() ? scene.positions[index] : state.positions[index - object.firstVertex];
      return (glm::dvec3(toWorld * glm::dvec4(glm::dvec3(local), 1.0)) - gridLow) / voxelSize;
    };
    for (const Part& part : object.parts) {
      const int texture = scene.materials[static_cast<std::size_t>(part.material)].maskTexture;
      const SurfaceTexture* mask = texture < 0 ? nullptr : &scene.textures[static_cast<std::size_t>(texture)];
      tbb::parallel_for(
          tbb::blocked_range<std::size_t>(0, part.indexCount / 3, kGrain), [&](const auto& range) {
            for (std::size_t i = range.begin(); i != range.end(); ++i) {
              const std::uint32_t* indices = &scene.indices[part.firstIndex + 3 * i];
              const ExactTriangle triangle{corner(indices[0]), corner(indices[1]), corner(indices[2])};
              if (mask == nullptr) {
                marker.mark(triangle, {});
                continue;
              }
              const measure::MaskedTriangle masked(
                  triangle,
                  {scene.texcoords[indices[0]], scene.texcoords[indices[1]], scene.texcoords[indices[2]]},
                  *mask);
              marker.mark(triangle, [&](const glm::ivec3& voxel) {
                const measure::MaskedTriangle::Within within = masked.within(voxel, tolerance);
                return within.solid ? Solid::yes : within.reachesSolid ? Solid::perhaps : Solid::no;
              });
            }
          });
    }
  }
  return reference;
}

}  // namespace lumivox
