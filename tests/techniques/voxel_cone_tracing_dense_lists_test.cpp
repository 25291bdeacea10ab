// Injection of fragment lists that are made here: their dispatches, known light, and how far sums are
// rounded.
#include <array>
#include <glm/gtc/packing.hpp>

#include "support/cones.h"
#include "support/voxel_fragments.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::cones;

namespace {

constexpr float kAmbient = static_cast<float>(kPi);  // W/m^2: a fragment reflects its albedo

FragmentData fragment(const glm::ivec3& cell, float albedo) {
  FragmentData result{};
  result.voxel = static_cast<std::uint32_t>(cell.x | cell.y << 10 | cell.z << 20);
  result.albedoRg = glm::packHalf2x16(glm::vec2(albedo));
  result.albedoBCoverage = glm::packHalf2x16(glm::vec2(albedo, 1.0f));
  return result;
}

/// `columns` by `rows` groups are dispatched over the list.
VoxelFragments listOf(const std::vector<FragmentData>& fragments, const glm::ivec3& size,
                      std::uint32_t columns, std::uint32_t rows) {
  VoxelFragments list;
  list.grid = {glm::vec3(-1.0f), 0.01f, size};
  list.capacity = fragments.size();
  list.fragments = std::make_shared<gpu::Buffer>(device(), list.capacity * sizeof(FragmentData), "list");
  list.fragments->uploadValues(std::span<const FragmentData>(fragments));
  const std::array<std::uint32_t, 4> words{static_cast<std::uint32_t>(fragments.size()), columns, rows, 1};
  REQUIRE(columns * rows * 64u >= words[0]);
  list.count = std::make_shared<gpu::Buffer>(device(), sizeof(words), "count");
  list.count->uploadValues(std::span<const std::uint32_t>(words));
  return list;
}

RadianceGrid injected(const VoxelFragments& list, const char* precision = "float") {
  const Scene scene = emptyScene();
  PassHarness inject(device(), techniques(), "voxel_cone_tracing", "inject", scene, snapshotOf(scene, 0.0));
  inject.setParameter("precision", std::string(precision));
  inject.setParameter("ambient", kAmbient);
  inject.setInput("fragments", list);
  inject.run();
  return inject.output<RadianceGrid>("radiance");
}

}  // namespace

TEST_CASE("every fragment of a list is injected, in however many rows of groups it is dispatched") {
  constexpr int kSide = 8, kCount = 400;
  std::vector<FragmentData> fragments;
  const auto albedo = [](int i) { return 0.25f + 0.5f * static_cast<float>(i) / kCount; };
  for (int i = 0; i < kCount; ++i)
    fragments.push_back(fragment({i % kSide, i / kSide % kSide, i / (kSide * kSide)}, albedo(i)));
  for (const glm::uvec2 groups : {glm::uvec2(7, 1), {3, 3}, {2, 4}, {1, 7}}) {
    CAPTURE(groups.x, groups.y);
    const RadianceGrid grid = injected(listOf(fragments, glm::ivec3(kSide), groups.x, groups.y));
    const std::vector<float> values = grid.radiance->downloadFloats(0);
    for (std::size_t i = 0; i < values.size() / 4; ++i) {
      const bool occupied = i < kCount;
      CHECK(values[4 * i + 3] == (occupied ? 1.0f : 0.0f));
      CHECK(values[4 * i] == Approx(occupied ? albedo(static_cast<int>(i)) : 0.0f).epsilon(1e-3));
    }
  }
}

TEST_CASE("a grid with more occupied bricks than a row of groups holds has all of them, at every level") {
  // OpenGL promises 65535 groups along an axis; here are 64 x 64 x 16 = 65536 bricks of one fragment each.
  std::vector<FragmentData> fragments;
  for (int z = 0; z < 16; ++z)
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) fragments.push_back(fragment(4 * glm::ivec3(x, y, z), 0.5f));
  const RadianceGrid grid = filtered(injected(listOf(fragments, {256, 256, 64}, 1024, 1), "half"));
  REQUIRE(grid.grid.resolution == glm::ivec3(256, 256, 64));
  const std::vector<float> bricks = grid.radiance->downloadFloats(2);
  REQUIRE(bricks.size() == 4u * 65536u);
  // One opaque voxel covers a quarter of the columns of a voxel of level 1, and that one a quarter again.
  std::size_t right = 0;
  for (std::size_t i = 3; i < bricks.size(); i += 4) right += std::abs(bricks[i] - 1.0f / 16.0f) < 1e-3f;
  CHECK(right == 65536u);
}

TEST_CASE(
    "what fragments are known to reflect is taken in place of the lights, up to what any voxel can send") {
  // Without lights that is 1 W/(sr m^2) and the albedo of a white surface in the ambient light.
  SceneBuilder builder;
  builder.scene = emptyScene();
  const auto shared = [](std::uint32_t mantissa, std::uint32_t exponent) {
    return mantissa | mantissa << 8 | mantissa << 16 | (exponent + 128u) << 24;
  };
  std::vector<FragmentData> fragments;
  for (int i = 0; i < 4; ++i) fragments.push_back(fragment({i, 1, 2}, 0.5f));
  VoxelFragments list = listOf(fragments, glm::ivec3(8), 1, 1);
  // 192 / 256 * 2^0, nothing known, and 128 / 256 * 2^4; of the last there is no word.
  const std::array<std::uint32_t, 3> words{shared(192u, 0u), VoxelFragments::kNotKnown, shared(128u, 4u)};
  list.reflected = std::make_shared<gpu::Buffer>(device(), sizeof(words), "reflected");
  list.reflected->uploadValues(std::span<const std::uint32_t>(words));
  const std::vector<float> values = injected(list).radiance->downloadFloats(0);
  const std::array<float, 4> expected{0.75f + 0.5f, 0.5f, 2.0f, 0.5f};
  for (std::size_t i = 0; i < expected.size(); ++i)
    CHECK(values[4 * (i + 8 * (1 + 8 * 2))] == Approx(expected[i]).epsilon(1e-3));
}

TEST_CASE("a mean over many fragments is wrong by half a unit of 2^-31 for each of them at most") {
  // Shares of 2^31 / n are rounded to the nearest: for n = 100000 that is 0.16 less than the next whole
  // number.
  constexpr int kCount = 100000;
  constexpr double kMost = kCount * 0.5 / 2147483648.0 + 1e-6;
  const std::vector<FragmentData> fragments(kCount, fragment({3, 4, 5}, 0.5f));
  const std::vector<float> values =
      injected(listOf(fragments, glm::ivec3(8), 1563, 1)).radiance->downloadFloats(0);
  const float* voxel = values.data() + 4 * (3 + 8 * (4 + 8 * 5));
  CHECK(std::abs(voxel[3] - 1.0) < kMost);
  for (int c = 0; c < 3; ++c) CHECK(std::abs(voxel[c] / 0.5 - 1.0) < kMost);
}
