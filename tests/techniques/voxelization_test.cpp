#include <algorithm>
#include <map>
#include <random>
#include <set>

#include "lumivox/measure/voxels.h"
#include "support/passes.h"
#include "support/voxel_fragments.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

Voxels voxelize(const Scene& scene, int resolution, const char* depth = "conservative",
                const char* method = "automatic") {
  return voxelsOf(fragmentsIn(scene, {{"resolution", resolution}, {"depth", depth}, {"method", method}}));
}

/// Against the exact overlap test.
VoxelError errorOf(const Scene& scene, const Voxels& voxels) {
  VoxelSet set(voxels.grid.resolution);
  for (const Cell& cell : voxels.occupied) set.insert({cell[0], cell[1], cell[2]});
  return compareVoxels(set, trueVoxels(scene, snapshotOf(scene, 0.0), voxels.grid));
}

Scene randomTriangles(int count, float size, unsigned seed) {
  SceneBuilder builder;
  const int grey = builder.lambert(0.5f);
  std::mt19937 generator(seed);
  std::uniform_real_distribution<float> uniform(-1.0f, 1.0f);
  const auto vector = [&] { return glm::vec3(uniform(generator), uniform(generator), uniform(generator)); };
  for (int i = 0; i < count; ++i) {
    const glm::vec3 corner = vector(), side = size * vector();
    builder.mesh({corner, corner + side, corner + side + size * vector()}, grey);
  }
  return builder.scene;
}

}  // namespace

TEST_CASE("conservative depth marks every voxel that an exact overlap test marks and no other") {
  for (const char* method : {"raster", "compute"}) {
    for (const float size : {0.02f, 0.2f, 1.5f}) {
      const Scene scene = randomTriangles(200, size, 7);
      const Voxels voxels = voxelize(scene, 48, "conservative", method);
      const VoxelError error = errorOf(scene, voxels);
      INFO(method << ", size " << size << ", occupied " << voxels.occupied.size());
      CHECK(error.truePositive > 100);
      CHECK(error.falseNegative == 0);
      CHECK(error.falsePositive == 0);
    }
  }
}

TEST_CASE("with depth at the pixel's centre only, steep triangles lose voxels but none is invented") {
  const Scene scene = randomTriangles(200, 1.0f, 11);
  const Voxels all = voxelize(scene, 48), centre = voxelize(scene, 48, "centre");
  CHECK(centre.occupied.size() < all.occupied.size());
  CHECK(std::includes(all.occupied.begin(), all.occupied.end(), centre.occupied.begin(),
                      centre.occupied.end()));
}

TEST_CASE("a needle of one to a million still marks every voxel along it") {
  SceneBuilder builder;
  Object& object = builder.quad({-1, -1, -1}, {2, 1.9f, 1.8f}, {1e-6f, -1e-6f, 0}, builder.lambert(0.5f));
  object.parts.front().indexCount = 3;
  const Voxels voxels = voxelize(builder.scene, 32);
  const VoxelError error = errorOf(builder.scene, voxels);
  CHECK(error.truePositive > 30);
  CHECK(error.falseNegative == 0);
}

TEST_CASE(
    "needles of any width mark every voxel along them, wherever their short edge is in the order of corners") {
  for (int turn = 0; turn < 3; ++turn) {
    SceneBuilder builder;
    const int grey = builder.lambert(0.5f);
    std::mt19937 generator(13);
    std::uniform_real_distribution<float> uniform(-1.0f, 1.0f);
    const auto vector = [&] { return glm::vec3(uniform(generator), uniform(generator), uniform(generator)); };
    for (int i = 0; i < 200; ++i) {
      const float width = std::pow(10.0f, -4.5f + 2.5f * uniform(generator));
      const glm::vec3 first = vector(), corners[3] = {first, first + width * vector(), vector()};
      builder.mesh({corners[turn], corners[(turn + 1) % 3], corners[(turn + 2) % 3]}, grey);
    }
    for (const char* method : {"raster", "compute"}) {
      const Voxels voxels = voxelize(builder.scene, 64, "conservative", method);
      const VoxelError error = errorOf(builder.scene, voxels);
      CAPTURE(method, turn);
      CHECK(error.truePositive > 5000);
      CHECK(error.falseNegative == 0);
      CHECK(error.falsePositive == 0);
    }
  }
}

TEST_CASE("an axis-aligned box occupies exactly the shell of its voxels") {
  SceneBuilder builder;
  builder.box({-1, -1, -1}, {1, 1, 1}, builder.lambert(0.5f), false);
  const Voxels voxels = voxelize(builder.scene, 16);
  // One empty voxel on each side: the box spans 14 voxels, and its shell is 14^3 - 12^3.
  CHECK(voxels.occupied.size() == 14u * 14u * 14u - 12u * 12u * 12u);
}

TEST_CASE("many triangles in one voxel make as many fragments, beyond what fits at first") {
  SceneBuilder builder;
  const int grey = builder.lambert(0.5f);
  builder.box({-1, -1, -1}, {1, 1, 1}, grey, false);
  for (int i = 0; i < 400; ++i) builder.quad({0.05f, 0.05f, 0.05f}, {0.01f, 0, 0}, {0, 0.01f, 0}, grey);
  const Voxels voxels = voxelize(builder.scene, 8);
  std::map<std::uint32_t, std::size_t> perVoxel;
  for (const FragmentData& fragment : voxels.fragments) ++perVoxel[fragment.voxel];
  std::size_t most = 0;
  for (const auto& [voxel, count] : perVoxel) most = std::max(most, count);
  CHECK(most == 800);  // two triangles each
}

TEST_CASE("the rasteriser and the compute shader find the same voxels with the same attributes to the bit") {
  for (const float size : {0.02f, 0.1f, 0.3f, 1.5f}) {
    const Scene scene = randomTriangles(300, size, 21);
    for (const int resolution : {1, 5, 48, 200})
      for (const char* depth : {"conservative", "centre"}) {
        CAPTURE(size, resolution, depth);
        const Voxels raster = voxelize(scene, resolution, depth, "raster"),
                     compute = voxelize(scene, resolution, depth, "compute");
        CHECK(raster.fragments == compute.fragments);
        CHECK(raster.fragments.size() >= 100);
      }
  }
}

TEST_CASE("more rows of large triangles than their list has room for are found all the same", "[slow]") {
  SceneBuilder builder;
  const int grey = builder.lambert(0.5f);
  // 1200 triangles half a voxel wide and 1022 tall: 128 rows of tiles each, and room for 131072 rows.
  for (int i = 0; i < 600; ++i) {
    const float place = static_cast<float>(i) / 300.0f - 1.0f;
    builder.quad({place, -1, 0.3f * place}, {1e-3f, 0, 0}, {0, 2, 0.01f}, grey);
  }
  const Voxels raster = voxelize(builder.scene, 1024, "conservative", "raster"),
               compute = voxelize(builder.scene, 1024, "conservative", "compute");
  CHECK(raster.fragments.size() > 1000000);
  CHECK((raster.fragments == compute.fragments));
}

TEST_CASE("triangles on the faces of voxels, needles and points are the same for both ways") {
  SceneBuilder builder;
  const int grey = builder.lambert(0.5f);
  // Corners on multiples of a quarter in a grid of 16 voxels per unit: faces and edges of voxels.
  builder.box({-0.5f, -0.25f, -1}, {0.5f, 0.25f, 1}, grey, false);
  builder.quad({-1, -1, -1}, {2, 1.9f, 1.8f}, {1e-6f, -1e-6f, 0}, grey);
  builder.quad({0.3f, 0.2f, 0.1f}, {0, 0, 0}, {0, 0, 0}, grey);
  builder.quad({-0.7f, 0.3f, 0}, {1.4f, 0, 0}, {0.7f, 0, 0}, grey);
  for (Object& object : builder.scene.objects) {
    for (std::uint32_t v = 0; v < object.vertexCount; ++v)
      builder.scene.normals[object.firstVertex + v] = {0, 1, 0};
  }
  const auto around = [&](const char* method) {
    return voxelsOf(fragmentsIn(
        builder.scene, {{"resolution", 64}, {"around", "camera"}, {"extent", 4}, {"method", method}}));
  };
  const Voxels raster = around("raster"), compute = around("compute");
  CHECK(raster.fragments == compute.fragments);
  CHECK(raster.occupied.size() > 1000);
}

TEST_CASE("the grid contains the whole scene whatever the resolution") {
  const Scene scene = randomTriangles(50, 0.5f, 5);
  const SceneSnapshot snapshot = snapshotOf(scene, 0.0);
  for (const int resolution : {1, 2, 3, 63, 64, 65}) {
    const GridPlacement grid = voxelize(scene, resolution).grid;
    for (int axis = 0; axis < 3; ++axis) {
      CHECK(grid.low[axis] <= snapshot.bounds.low[axis]);
      CHECK(grid.low[axis] + grid.voxelSize * static_cast<float>(grid.resolution[axis]) >=
            snapshot.bounds.high[axis]);
      CHECK(grid.resolution[axis] <= resolution);
    }
  }
}
