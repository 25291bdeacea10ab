// Where voxel grids lie: around the scene with a margin, around the camera on whole voxels, nested.
#include "lumivox/toolkit/grid_placement.h"

#include <cmath>
#include <vector>

#include "support/support.h"

using namespace lumivox;

namespace {

Bounds boundsOf(const glm::vec3& low, const glm::vec3& high) {
  Bounds bounds;
  bounds.grow(low);
  bounds.grow(high);
  return bounds;
}

glm::vec3 highOf(const GridPlacement& grid) {
  return grid.low + glm::vec3(grid.resolution) * grid.voxelSize;
}

/// Whole voxels between the corners of two grids of one voxel size, and how far that is from whole.
glm::dvec3 voxelsBetween(const GridPlacement& a, const GridPlacement& b) {
  return (glm::dvec3(b.low) - glm::dvec3(a.low)) / static_cast<double>(a.voxelSize);
}

double offWhole(const glm::dvec3& voxels) {
  const glm::dvec3 off = glm::abs(voxels - glm::round(voxels));
  return std::max({off.x, off.y, off.z});
}

}  // namespace

TEST_CASE("a grid around bounds has its resolution along the longest side and an empty margin") {
  const GridPlacement grid = placeGrid(boundsOf({-2, 0, 1}, {2, 1, 3}), 34);
  CHECK(grid.resolution.x == 34);
  // 4 m over 32 voxels, and half of a thousandth more.
  CHECK(grid.voxelSize == Approx(4.0f / 32.0f).epsilon(1e-3));
  CHECK(grid.voxelSize > 4.0f / 32.0f);
  // 1 m and 2 m are 8 and 16 voxels; the margin adds two.
  CHECK(grid.resolution.y == 10);
  CHECK(grid.resolution.z == 18);
  for (int axis = 0; axis < 3; ++axis) {
    const float below = (glm::vec3(-2, 0, 1)[axis] - grid.low[axis]) / grid.voxelSize;
    const float above = (highOf(grid)[axis] - glm::vec3(2, 1, 3)[axis]) / grid.voxelSize;
    CHECK(below >= 1.0f);
    CHECK(above >= 1.0f);
    CHECK(below == Approx(above).margin(1e-3));
    CHECK(below < 1.6f);
  }
}

TEST_CASE("a coarse grid does without its margin and still holds the bounds") {
  for (int resolution = 1; resolution < 8; ++resolution) {
    INFO(resolution);
    const GridPlacement grid = placeGrid(boundsOf({0, 0, 0}, {1, 0.4f, 0.1f}), resolution);
    CHECK(grid.resolution.x == resolution);
    for (int axis = 0; axis < 3; ++axis) {
      CHECK(grid.low[axis] <= 0.0f);
      CHECK(highOf(grid)[axis] >= glm::vec3(1, 0.4f, 0.1f)[axis]);
    }
  }
}

TEST_CASE("flat, pointlike and empty bounds make grids of cubic voxels") {
  const GridPlacement flat = placeGrid(boundsOf({0, 2, 0}, {1, 2, 1}), 16);
  // In the middle of a voxel, with an empty one on both sides.
  CHECK(flat.resolution.y == 3);
  CHECK((2.0f - flat.low.y) / flat.voxelSize == Approx(1.5f));
  const GridPlacement point = placeGrid(boundsOf({3, 3, 3}, {3, 3, 3}), 16);
  CHECK(point.voxelSize > 0.0f);
  CHECK(glm::all(glm::lessThanEqual(point.low, glm::vec3(3))));
  CHECK(glm::all(glm::greaterThanEqual(highOf(point), glm::vec3(3))));
  const GridPlacement empty = placeGrid({}, 16);
  CHECK(empty.resolution == glm::ivec3(16));
  CHECK(empty.voxelSize == Approx(1.0 / 14.0).epsilon(1e-3));
}

TEST_CASE("a grid around a camera is a cube that holds it in the middle voxel, give or take half a voxel") {
  for (const int resolution : {1, 2, 31, 64, 1024}) {
    const glm::vec3 eye(0.31f, -7.77f, 12.3f);
    const GridPlacement grid = placeGridAround(eye, 3.2f, resolution);
    CHECK(grid.resolution == glm::ivec3(resolution));
    CHECK(grid.voxelSize * static_cast<float>(resolution) == Approx(3.2f));
    const glm::vec3 middle = 0.5f * (grid.low + highOf(grid));
    for (int axis = 0; axis < 3; ++axis) CHECK(std::abs(middle[axis] - eye[axis]) <= 0.501f * grid.voxelSize);
  }
}

TEST_CASE("a grid around a camera moves by whole voxels") {
  const GridPlacement first = placeGridAround({0, 0, 0}, 4.0f, 32);
  int still = 0, moved = 0;
  for (int i = 1; i < 50; ++i) {
    const GridPlacement now =
        placeGridAround(glm::vec3(0.013, -0.02, 0.007) * static_cast<float>(i), 4.0f, 32);
    CHECK(offWhole(voxelsBetween(first, now)) < 1e-5);
    (now == first ? still : moved) += 1;
  }
  CHECK(still >= 1);
  CHECK(moved >= 30);
}

TEST_CASE("a scene of another scale has the same voxels around its camera, whatever the rounding") {
  const std::vector<glm::vec3> eyes{{0, 0, 0}, {0.31f, -7.77f, 12.3f}, {0.0f, 0.0014f, -1.08f}};
  for (const int resolution : {1, 2, 31, 32}) {
    for (const glm::vec3& eye : eyes) {
      const GridPlacement grid = placeGridAround(eye, 3.2f, resolution);
      for (const float scale : {1e-3f, 3.0f, 1e3f}) {
        INFO(resolution << " voxels, scale " << scale);
        const GridPlacement scaled = placeGridAround(scale * eye, scale * 3.2f, resolution);
        CHECK(scaled.resolution == grid.resolution);
        for (int axis = 0; axis < 3; ++axis)
          CHECK(scaled.low[axis] / scale == Approx(grid.low[axis]).margin(1e-5).epsilon(1e-5));
      }
    }
  }
}

TEST_CASE("each nested grid has voxels of twice the size, its middle on whole multiples of its own") {
  for (int level = 0; level < 5; ++level) {
    const GridPlacement grid = placeNestedGrid({0.3f, 0.2f, 0.1f}, 2.0f, 16, level);
    CHECK(grid.resolution == glm::ivec3(16));
    CHECK(grid.voxelSize == Approx(2.0f / 16.0f * static_cast<float>(1 << level)));
    CHECK(offWhole(glm::dvec3(grid.low) / static_cast<double>(grid.voxelSize)) < 1e-4);
    if (level == 0) continue;
    const GridPlacement finer = placeNestedGrid({0.3f, 0.2f, 0.1f}, 2.0f, 16, level - 1);
    CHECK(glm::all(glm::lessThanEqual(grid.low, finer.low)));
    CHECK(glm::all(glm::greaterThanEqual(highOf(grid), highOf(finer))));
  }
}
