#include <algorithm>
#include <glm/gtc/packing.hpp>
#include <random>
#include <set>

#include "support/scene_builder.h"
#include "support/techniques.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

struct Fragment {  // mirror of VoxelFragment in shaders/common/voxel.glsl
  std::uint32_t voxel, offset, normal, albedoRg, albedoBCoverage, emission;
};
using Cell = std::array<int, 3>;

struct Voxels {
  GridPlacement grid;
  std::vector<Fragment> fragments;
  std::set<Cell> occupied;
};

Voxels voxelise(const Scene& scene, int resolution, const char* depth = "conservative") {
  const SceneSnapshot snapshot = snapshotOf(scene, 0.0);
  PassHarness harness(device(), techniques(), "voxelization", "conservative", scene, snapshot);
  harness.setParameter("resolution", resolution);
  harness.setParameter("depth", std::string(depth));
  harness.run();
  const auto& output = harness.output<VoxelFragments>("fragments");
  Voxels result{output.grid, {}, {}};
  const std::uint32_t count = output.count->downloadValues<std::uint32_t>()[0];
  result.fragments = output.fragments->downloadValues<Fragment>();
  REQUIRE(count <= result.fragments.size());
  result.fragments.resize(count);
  for (const Fragment& fragment : result.fragments) {
    result.occupied.insert({static_cast<int>(fragment.voxel & 1023),
                            static_cast<int>(fragment.voxel >> 10 & 1023),
                            static_cast<int>(fragment.voxel >> 20 & 1023)});
  }
  return result;
}

/// Exact overlap of a triangle with an axis-aligned box by the separating axis theorem in double precision
/// (Akenine-Moller 2001): 3 box normals, the triangle's normal, 9 cross products of edges. `slack` widens
/// (positive) or shrinks the box.
bool overlaps(const std::array<glm::dvec3, 3>& triangle, const glm::dvec3& centre, double half,
              double slack) {
  std::array<glm::dvec3, 3> v;
  for (int i = 0; i < 3; ++i) v[i] = triangle[i] - centre;
  const double h = half + slack;
  const auto separated = [&](const glm::dvec3& axis) {
    const double a = glm::dot(axis, v[0]), b = glm::dot(axis, v[1]), c = glm::dot(axis, v[2]);
    const double reach = h * (std::abs(axis.x) + std::abs(axis.y) + std::abs(axis.z));
    return std::min({a, b, c}) > reach || std::max({a, b, c}) < -reach;
  };
  const std::array<glm::dvec3, 3> unit{glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1)};
  for (const glm::dvec3& axis : unit) {
    if (separated(axis)) return false;
  }
  if (separated(glm::cross(v[1] - v[0], v[2] - v[0]))) return false;
  for (int e = 0; e < 3; ++e) {
    for (const glm::dvec3& axis : unit) {
      if (separated(glm::cross(v[(e + 1) % 3] - v[e], axis))) return false;
    }
  }
  return true;
}

std::set<Cell> truth(const Scene& scene, const GridPlacement& grid, double slack) {
  const SceneSnapshot snapshot = snapshotOf(scene, 0.0);
  std::set<Cell> cells;
  for (std::size_t o = 0; o < scene.objects.size(); ++o) {
    for (const Part& part : scene.objects[o].parts) {
      for (std::uint32_t i = 0; i < part.indexCount; i += 3) {
        std::array<glm::dvec3, 3> triangle;
        glm::dvec3 low(1e300), high(-1e300);
        for (std::uint32_t k = 0; k < 3; ++k) {
          const glm::vec3 local = scene.positions[scene.indices[part.firstIndex + i + k]];
          const glm::vec3 world(snapshot.objects[o].toWorld * glm::vec4(local, 1.0f));
          triangle[k] = glm::dvec3(world - grid.low) / static_cast<double>(grid.voxelSize);
          low = glm::min(low, triangle[k]);
          high = glm::max(high, triangle[k]);
        }
        for (int x = static_cast<int>(low.x - 1); x <= high.x + 1; ++x)
          for (int y = static_cast<int>(low.y - 1); y <= high.y + 1; ++y)
            for (int z = static_cast<int>(low.z - 1); z <= high.z + 1; ++z) {
              if (x < 0 || y < 0 || z < 0 || x >= grid.resolution.x || y >= grid.resolution.y ||
                  z >= grid.resolution.z)
                continue;
              if (overlaps(triangle, glm::dvec3(x, y, z) + 0.5, 0.5, slack)) cells.insert({x, y, z});
            }
      }
    }
  }
  return cells;
}

Scene randomTriangles(int count, float size, unsigned seed) {
  SceneBuilder builder;
  const int grey = builder.lambert(0.5f);
  std::mt19937 generator(seed);
  std::uniform_real_distribution<float> uniform(-1.0f, 1.0f);
  const auto vector = [&] { return glm::vec3(uniform(generator), uniform(generator), uniform(generator)); };
  for (int i = 0; i < count; ++i) {
    Object& object = builder.quad(vector(), size * vector(), size * vector(), grey);
    object.parts.front().indexCount = 3;  // one triangle of the quad
    builder.scene.indices.resize(builder.scene.indices.size() - 3);
  }
  return builder.scene;
}

}  // namespace

TEST_CASE("conservative depth marks every voxel that an exact overlap test marks and hardly any other") {
  // Float rounding decides contacts closer than a ten-thousandth of a voxel; both sides of that are accepted.
  constexpr double kSlack = 1e-3;
  for (const float size : {0.02f, 0.2f, 1.5f}) {
    const Scene scene = randomTriangles(200, size, 7);
    const Voxels voxels = voxelise(scene, 48);
    const std::set<Cell> inner = truth(scene, voxels.grid, -kSlack),
                         outer = truth(scene, voxels.grid, kSlack);
    std::size_t missed = 0, wrong = 0;
    for (const Cell& cell : inner) missed += voxels.occupied.count(cell) == 0;
    for (const Cell& cell : voxels.occupied) wrong += outer.count(cell) == 0;
    INFO("size " << size << ", truth " << inner.size() << ", occupied " << voxels.occupied.size());
    CHECK(inner.size() > 100);
    CHECK(missed == 0);
    CHECK(wrong == 0);
  }
}

TEST_CASE("with depth at the pixel's centre only, steep triangles lose voxels but none is invented") {
  const Scene scene = randomTriangles(200, 1.0f, 11);
  const Voxels all = voxelise(scene, 48), centre = voxelise(scene, 48, "centre");
  CHECK(centre.occupied.size() < all.occupied.size());
  CHECK(std::includes(all.occupied.begin(), all.occupied.end(), centre.occupied.begin(),
                      centre.occupied.end()));
}

TEST_CASE("a needle of one to a million still marks every voxel along it") {
  SceneBuilder builder;
  Object& object = builder.quad({-1, -1, -1}, {2, 1.9f, 1.8f}, {1e-6f, -1e-6f, 0}, builder.lambert(0.5f));
  object.parts.front().indexCount = 3;
  const Voxels voxels = voxelise(builder.scene, 32);
  const std::set<Cell> exact = truth(builder.scene, voxels.grid, -1e-3);
  CHECK(exact.size() > 30);
  for (const Cell& cell : exact) CHECK(voxels.occupied.count(cell) == 1);
}

TEST_CASE("an axis-aligned box occupies exactly the shell of its voxels") {
  SceneBuilder builder;
  builder.box({-1, -1, -1}, {1, 1, 1}, builder.lambert(0.5f), false);
  const Voxels voxels = voxelise(builder.scene, 16);
  // One empty voxel on each side: the box spans 14 voxels, and its shell is 14^3 - 12^3.
  CHECK(voxels.occupied.size() == 14u * 14u * 14u - 12u * 12u * 12u);
}

TEST_CASE("every fragment keeps the albedo of its material and a normal of unit length") {
  SceneBuilder builder;
  Material material;
  material.diffuse = {0.25f, 0.5f, 0.75f};
  builder.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, builder.material(material));
  const Voxels voxels = voxelise(builder.scene, 16);
  REQUIRE(!voxels.fragments.empty());
  for (const Fragment& fragment : voxels.fragments) {
    const glm::vec2 redGreen = glm::unpackHalf2x16(fragment.albedoRg),
                    blueCoverage = glm::unpackHalf2x16(fragment.albedoBCoverage);
    CHECK(redGreen.x == 0.25f);
    CHECK(redGreen.y == 0.5f);
    CHECK(blueCoverage.x == 0.75f);
    CHECK(blueCoverage.y == 1.0f);
    const glm::vec2 octahedral = glm::unpackSnorm2x16(fragment.normal);
    CHECK(octahedral.x == Approx(0.0f).margin(1e-4));  // +y lies at (0, 1)
    CHECK(octahedral.y == Approx(1.0f).margin(1e-4));
  }
}

TEST_CASE("many triangles in one voxel make as many fragments, beyond what fits at first") {
  SceneBuilder builder;
  const int grey = builder.lambert(0.5f);
  builder.box({-1, -1, -1}, {1, 1, 1}, grey, false);
  for (int i = 0; i < 400; ++i) builder.quad({0.05f, 0.05f, 0.05f}, {0.01f, 0, 0}, {0, 0.01f, 0}, grey);
  const Voxels voxels = voxelise(builder.scene, 8);
  std::size_t most = 0;
  for (const Fragment& fragment : voxels.fragments) {
    most = std::max<std::size_t>(most, static_cast<std::size_t>(std::count_if(
                                           voxels.fragments.begin(), voxels.fragments.end(),
                                           [&](const Fragment& f) { return f.voxel == fragment.voxel; })));
    if (most >= 800) break;
  }
  CHECK(most == 800);  // two triangles each
}

TEST_CASE("an empty scene and a resolution of one voxel are no special cases") {
  SceneBuilder empty;
  CHECK(voxelise(empty.scene, 16).fragments.empty());
  const Scene scene = randomTriangles(10, 0.5f, 3);
  CHECK(voxelise(scene, 1).occupied.size() == 1);
  CHECK(!voxelise(scene, 2).occupied.empty());
  CHECK(!voxelise(scene, 3).occupied.empty());
}

TEST_CASE("the grid holds the whole scene whatever the resolution") {
  const Scene scene = randomTriangles(50, 0.5f, 5);
  const SceneSnapshot snapshot = snapshotOf(scene, 0.0);
  for (const int resolution : {1, 2, 3, 63, 64, 65}) {
    const GridPlacement grid = voxelise(scene, resolution).grid;
    for (int axis = 0; axis < 3; ++axis) {
      CHECK(grid.low[axis] <= snapshot.bounds.low[axis]);
      CHECK(grid.low[axis] + grid.voxelSize * static_cast<float>(grid.resolution[axis]) >=
            snapshot.bounds.high[axis]);
      CHECK(grid.resolution[axis] <= resolution);
    }
  }
}
