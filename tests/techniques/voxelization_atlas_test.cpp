// Voxels from a texture atlas of the surface, as bits and with attributes.
#include <algorithm>
#include <cmath>

#include "lumivox/base/error.h"
#include "support/facts.h"
#include "support/meshes.h"
#include "support/voxelizers.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

LonePass atlas(const Scene& scene, const char* pass, int resolution, double texelsPerVoxel = 2.0,
               double pointSize = 1.0) {
  Settings settings{{"resolution", resolution}, {"texels_per_voxel", texelsPerVoxel}};
  if (pointSize != 1.0) settings.emplace_back("point_size", pointSize);
  return LonePass(std::string("voxelization.") + pass, scene, settings);
}
std::set<Cell> bitsOf(const Scene& scene, int resolution, double texelsPerVoxel = 2.0,
                      double pointSize = 1.0) {
  return cellsOf(atlas(scene, "atlas_binary", resolution, texelsPerVoxel, pointSize).out<BinaryGrid>("bits"));
}
Voxels attributesOf(const Scene& scene, int resolution) {
  return voxelsOf(atlas(scene, "atlas_attributes", resolution).out<VoxelFragments>("fragments"));
}
std::set<Cell> conservative(const Scene& scene, int resolution) {
  return voxelsOf(fragmentsIn(scene, {{"resolution", resolution}})).occupied;
}

/// A box and a tilted plate.
Scene still() {
  SceneBuilder builder;
  const int grey = builder.lambert(0.5f, 2.0f);
  builder.box({-0.9f, -0.9f, -0.9f}, {-0.3f, 0.1f, 0.2f}, grey, false);
  builder.quad({0.9f, -0.9f, -0.8f}, {-0.5f, 1.4f, 0.3f}, {0.1f, 0.2f, 1.5f}, grey);
  return builder.scene;
}

}  // namespace

TEST_CASE("bits and fragments of an atlas are in the same voxels, one black fragment for every bit") {
  for (const int resolution : {16, 37, 48}) {
    const Scene scene = still();
    LonePass pass = atlas(scene, "atlas_binary", resolution);
    const Voxels voxels = voxelsOf(pass.out<VoxelFragments>("fragments"));
    const std::set<Cell> bits = cellsOf(pass.out<BinaryGrid>("bits")),
                         exact = conservative(scene, resolution);
    CHECK(bits == attributesOf(scene, resolution).occupied);
    CHECK(bits == voxels.occupied);
    CHECK(voxels.fragments.size() == bits.size());
    // Voxels that the surface only grazes are missed.
    CHECK(static_cast<double>(bits.size()) > 0.75 * static_cast<double>(exact.size()));
  }
}

TEST_CASE(
    "at the default density no line along an axis slips through a tilted plane, at a third of it some do") {
  // The plane crosses every column (x, z) of its extent: with texels 0.71 voxels apart at most, each column
  // whose middle lies well inside has a bit.
  SceneBuilder builder;
  builder.quad({-1, -0.3f, -1}, {0, 0.25f, 2}, {2, 0.35f, 0}, builder.lambert(0.5f));
  const auto emptyColumns = [&](double texelsPerVoxel) {
    const std::set<Cell> bits = bitsOf(builder.scene, 64, texelsPerVoxel);
    std::set<std::pair<int, int>> columns;
    for (const Cell& cell : bits) columns.insert({cell[0], cell[2]});
    int empty = 0;
    for (int x = 2; x < 62; ++x)
      for (int z = 2; z < 62; ++z) empty += columns.count({x, z}) == 0;
    return empty;
  };
  CHECK(emptyColumns(2.0) == 0);
  CHECK(emptyColumns(0.7) > 100);
}

TEST_CASE("no line along an axis passes a sphere without meeting its voxels where it crosses the sphere") {
  // Flat quads of a sphere of radius 1, finer than the voxels.
  SceneBuilder builder;
  builder.mesh(sphereCorners(96), builder.lambert(0.5f));
  const BinaryGrid grid = atlas(builder.scene, "atlas_binary", 64).out<BinaryGrid>("bits");
  const std::set<Cell> bits = cellsOf(grid);
  const glm::dvec3 low = glm::dvec3(grid.grid.low) + snapshotOf(builder.scene, 0.0).origin;
  const double voxel = grid.grid.voxelSize;
  std::size_t crossings = 0, missed = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 0; i < 64; ++i)
      for (int j = 0; j < 64; ++j) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        const double x = low[u] + (i + 0.5) * voxel, y = low[v] + (j + 0.5) * voxel;
        if (x * x + y * y >= 1.0 - 1.0 / 64.0) continue;  // farther in than the facets reach
        for (const double side : {-1.0, 1.0}) {
          const double depth = (side * std::sqrt(1.0 - x * x - y * y) - low[axis]) / voxel;
          bool met = false;
          for (int k = static_cast<int>(std::floor(depth - 1.5)); k <= static_cast<int>(depth + 1.5); ++k) {
            Cell cell{};
            cell[static_cast<std::size_t>(axis)] = k;
            cell[static_cast<std::size_t>(u)] = i;
            cell[static_cast<std::size_t>(v)] = j;
            met = met || bits.count(cell) == 1;
          }
          ++crossings;
          missed += !met;
        }
      }
  CHECK(crossings > 15000);
  CHECK(missed == 0);
}

TEST_CASE("each level of the stacks is the union of the finer one and keeps the depth") {
  checkLevelsAreUnions(atlas(still(), "atlas_binary", 37).out<BinaryGrid>("bits"));
}

TEST_CASE("an atlas that is too fine says how large it would be") {
  CHECK_THROWS_MATCHES(bitsOf(still(), 1024, 16.0), Error, Tells("atlas"));
}

TEST_CASE(
    "larger points close a wall across the stacks whose atlas is too small, and thicken one along them") {
  // 0.7 texels along a voxel are 1.43 voxels apart: whole rows and columns are missed. A point of side s
  // reaches the centres of voxels within s / 2 of it in x and y: 1.5 is enough where 1 is not. Along the
  // stacks, z, it reaches nothing (thesis 004, Listing 4.41: what grows is a point in the image of stacks).
  for (const int axis : {0, 2}) {
    INFO("a wall across "
         << "xyz"[axis]);
    SceneBuilder builder;
    glm::vec3 corner(-1.0f), edge1(0.0f), edge2(0.0f);
    corner[axis] = 0.013f;
    edge1[(axis + 1) % 3] = edge2[(axis + 2) % 3] = 2.0f;
    builder.quad(corner, edge1, edge2, builder.lambert(0.5f));
    const std::set<Cell> exact = conservative(builder.scene, 34), one = bitsOf(builder.scene, 34, 0.7),
                         larger = bitsOf(builder.scene, 34, 0.7, axis == 2 ? 1.5 : 2.5);
    const auto closed = [&](const std::set<Cell>& bits) {
      return std::count_if(exact.begin(), exact.end(),
                           [&](const Cell& cell) { return bits.count(cell) == 1; });
    };
    std::set<int> layers;
    for (const Cell& cell : larger) layers.insert(cell[static_cast<std::size_t>(axis)]);
    CHECK(one.size() < 0.6 * static_cast<double>(exact.size()));
    CHECK(std::includes(larger.begin(), larger.end(), one.begin(), one.end()));
    if (axis == 2) {
      CHECK(closed(larger) == static_cast<std::ptrdiff_t>(exact.size()));
      CHECK(layers.size() == 1);
    } else {
      // Rows along y are closed, whole rows along z stay missing: 0.7 of them are met.
      CHECK(static_cast<double>(closed(larger)) ==
            Approx(0.7 * static_cast<double>(exact.size())).epsilon(0.1));
      CHECK(layers.size() == 3);
    }
  }
}
