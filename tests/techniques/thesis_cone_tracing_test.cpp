// Listings 4.8 to 4.10, and passes over voxels as draws without attributes: what running averages in 8 bits
// must give is derived here from the printed code.
#include "support/thesis_cone_tracing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/packing.hpp>
#include <set>

#include "../../techniques/thesis_cone_tracing/voxel_averages.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::cones;
using Catch::Contains;
using thesis::mipmapped;
using thesis::passOf;
using thesis_cone_tracing::VoxelAverages;

namespace {

constexpr double kAmbient = 2000.0;  // W/m^2; without lights bytes are in units of this over pi and 1
constexpr double kUnit = 1.0 + kAmbient / kPi, kWhite = 255.0 * (kAmbient / kPi) / kUnit;

VoxelFragments listOf(const std::vector<std::pair<glm::ivec3, float>>& voxelsWithAlbedos,
                      const glm::ivec3& size) {
  std::vector<FragmentData> fragments;
  for (const auto& [voxel, albedo] : voxelsWithAlbedos) {
    FragmentData one{};
    one.voxel = static_cast<std::uint32_t>(voxel.x | voxel.y << 10 | voxel.z << 20);
    one.albedoRg = glm::packHalf2x16(glm::vec2(albedo));
    one.albedoBCoverage = glm::packHalf2x16(glm::vec2(albedo, 1.0f));
    fragments.push_back(one);
  }
  VoxelFragments list;
  list.grid = {glm::vec3(-1.0f), 0.25f, size};
  list.capacity = fragments.size();
  list.fragments = std::make_shared<gpu::Buffer>(device(), list.capacity * sizeof(FragmentData), "list");
  list.fragments->uploadValues(std::span<const FragmentData>(fragments));
  const auto count = static_cast<std::uint32_t>(fragments.size());
  const std::array<std::uint32_t, 4> words{count, (count + 63) / 64, 1, 1};
  list.count = std::make_shared<gpu::Buffer>(device(), sizeof(words), "count");
  list.count->uploadValues(std::span<const std::uint32_t>(words));
  return list;
}

VoxelAverages averagesOf(const VoxelFragments& list, const char* grids = "one") {
  const Scene scene = emptyScene();
  PassHarness inject = passOf("inject", scene);
  inject.setParameter("ambient", kAmbient);
  inject.setParameter("grids", std::string(grids));
  inject.setInput("fragments", list);
  inject.run();
  return inject.output<VoxelAverages>("averages");
}

template <class Grid>
Grid correctedAs(const char* pass, const VoxelAverages& averages, bool drawn = false) {
  const Scene scene = emptyScene();
  PassHarness correct = passOf(pass, scene);
  correct.setParameter("drawn", std::string(drawn ? "on" : "off"));
  correct.setInput("averages", averages);
  correct.run();
  return correct.template output<Grid>("radiance");
}
RadianceGrid corrected(const VoxelAverages& averages, bool drawn = false) {
  return correctedAs<RadianceGrid>("correct_opacity", averages, drawn);
}

/// The word of a voxel.
std::uint32_t wordAt(const VoxelAverages& averages, const glm::ivec3& voxel, std::size_t grid = 0) {
  const std::vector<std::byte> bytes = averages.grids[grid]->download(0);
  const int side = averages.grid.resolution.x;
  std::uint32_t word = 0;
  std::memcpy(&word, bytes.data() + 4 * ((voxel.z * side + voxel.y) * side + voxel.x), sizeof(word));
  return word;
}

/// Listing 4.9 for one channel of a voxel whose fragments come in this order.
std::pair<int, int> runningAverage(const std::vector<float>& albedos) {
  int byte = 0, count = 0;
  for (const float albedo : albedos) {
    const double sum = static_cast<double>(byte) * count + kWhite * albedo;
    count += 1;
    byte = static_cast<int>(std::floor(sum / count));
    count %= 256;
  }
  return {byte, count};
}

/// All bytes of all levels.
std::vector<std::byte> bytesOf(const gpu::Texture& texture) {
  std::vector<std::byte> all;
  for (int level = 0; level < texture.description().levels; ++level) {
    const std::vector<std::byte> one = texture.download(level);
    all.insert(all.end(), one.begin(), one.end());
  }
  return all;
}

}  // namespace

TEST_CASE(
    "the running average of a voxel is that of one order of its fragments, cut to 8 bits, and counts them") {
  std::vector<float> albedos{0.1f, 0.4f, 0.85f, 0.97f};
  std::vector<std::pair<glm::ivec3, float>> fragments;
  for (const float albedo : albedos) fragments.emplace_back(glm::ivec3(1, 2, 3), albedo);
  fragments.emplace_back(glm::ivec3(3, 0, 1), 0.3f);
  const VoxelAverages averages = averagesOf(listOf(fragments, glm::ivec3(4)));
  CHECK(averages.unit == Approx(kUnit));
  // Halves are a little less or more than these numbers; none of the averages is that near to a whole number.
  std::set<std::uint32_t> possible;
  do {
    const auto [byte, count] = runningAverage(albedos);
    possible.insert(static_cast<std::uint32_t>(byte | byte << 8 | byte << 16 | count << 24));
  } while (std::next_permutation(albedos.begin(), albedos.end()));
  REQUIRE(possible.size() > 1);
  CHECK(possible.contains(wordAt(averages, {1, 2, 3})));
  CHECK(wordAt(averages, {3, 0, 1}) == (76u | 76u << 8 | 76u << 16 | 1u << 24));
  CHECK(wordAt(averages, {0, 0, 0}) == 0u);
}

TEST_CASE("the count of fragments overflows at 256, and then 256 dark fragments leave a hole as published") {
  std::vector<std::pair<glm::ivec3, float>> fragments;
  for (int i = 0; i < 300; ++i) fragments.emplace_back(glm::ivec3(0, 0, 0), 0.5f);
  for (int i = 0; i < 256; ++i) fragments.emplace_back(glm::ivec3(1, 0, 0), 0.0f);
  for (int i = 0; i < 255; ++i) fragments.emplace_back(glm::ivec3(2, 0, 0), 0.0f);
  const VoxelAverages averages = averagesOf(listOf(fragments, glm::ivec3(4)));
  CHECK(wordAt(averages, {0, 0, 0}) == (127u | 127u << 8 | 127u << 16 | (300u - 256u) << 24));
  CHECK(wordAt(averages, {1, 0, 0}) == 0u);
  CHECK(wordAt(averages, {2, 0, 0}) == 255u << 24);
  const std::vector<float> grid = corrected(averages).radiance->downloadFloats(0);
  CHECK(grid[3] == 1.0f);
  CHECK(grid[0] == Approx(127.0 / 255.0));
  CHECK(grid[4 + 3] == 0.0f);  // none of 256 fragments is left
  CHECK(grid[2 * 4 + 3] == 1.0f);
}

TEST_CASE("correction makes all voxels opaque that hold anything, and no others") {
  const VoxelAverages averages =
      averagesOf(listOf({{{1, 1, 1}, 0.6f}, {{1, 1, 1}, 0.2f}, {{2, 3, 0}, 0.0f}}, {4, 4, 2}));
  CHECK(averages.grid.resolution == glm::ivec3(4));  // as many voxels along all axes
  const RadianceGrid grid = corrected(averages);
  const std::vector<float> texels = grid.radiance->downloadFloats(0);
  int opaque = 0;
  for (std::size_t i = 3; i < texels.size(); i += 4) {
    CHECK((texels[i] == 0.0f || texels[i] == 1.0f));
    opaque += texels[i] == 1.0f;
  }
  CHECK(opaque == 2);
  const std::size_t at = 4 * ((1 * 4 + 1) * 4 + 1);
  CHECK(texels[at] == Approx(wordAt(averages, {1, 1, 1}) % 256 / 255.0));
  CHECK(grid.unit == averages.unit);
}

TEST_CASE("light that falls on the front of fragments is averaged as printed to within the bytes") {
  SceneBuilder builder;
  builder.look({0, 0, 2}, {0, 0, 0}, {0, 1, 0}, 0.7, kPixels, kPixels);
  Material coloured;
  coloured.diffuse = {0.8f, 0.5f, 0.2f};
  builder.quad({-1, 0.06f, -1}, {0, 0, 2}, {1, 0, 0}, builder.material(coloured));
  builder.quad({0, -0.94f, -1}, {1, 0, 0}, {0, 0, 2}, builder.lambert(0.5f));  // looks down, in the sun
  builder.light(LightKind::directional, {3, 3, 3}, {}, {0.3, -1, 0.2});
  const Scene& scene = builder.scene;
  const SceneSnapshot snapshot = snapshotOf(scene, 0.0);
  PassHarness voxels(device(), techniques(), "voxelization", "conservative", scene, snapshot);
  voxels.setParameter("resolution", 16);
  voxels.run();
  PassHarness shadow(device(), techniques(), "direct_lighting", "shadow_map", scene, snapshot);
  shadow.run();
  PassHarness inject(device(), techniques(), "thesis_cone_tracing", "inject", scene, snapshot);
  inject.setInput("fragments", voxels.output<VoxelFragments>("fragments"));
  inject.setInput("shadow", shadow.output<ShadowMap>("depth"));
  inject.run();
  const RadianceGrid grid = corrected(inject.output<VoxelAverages>("averages"));
  // Largest radiance: what the sun sends to a surface that faces it, over pi.
  CHECK(grid.unit == Approx(3.0 / kPi));
  const glm::vec3 expected =
      glm::vec3(0.8f, 0.5f, 0.2f) * static_cast<float>(3.0 / kPi / std::sqrt(1.0 + 0.09 + 0.04));
  const std::vector<float> texels = grid.radiance->downloadFloats(0);
  int lit = 0, dark = 0;
  for (std::size_t i = 0; i < texels.size(); i += 4) {
    if (texels[i + 3] == 0.0f) continue;
    const glm::vec3 radiance = glm::vec3(texels[i], texels[i + 1], texels[i + 2]) * grid.unit;
    if (radiance == glm::vec3(0.0f)) {
      dark += 1;
      continue;
    }
    lit += 1;
    // A cut byte for each of the two fragments that a voxel has at most.
    for (int channel = 0; channel < 3; ++channel)
      CHECK(radiance[channel] == Approx(expected[channel]).margin(2.0 * grid.unit / 255.0));
  }
  CHECK(lit >= 14 * 7);   // a rim of voxels is beside the scene
  CHECK(dark >= 14 * 7);  // the side that looks away from the sun
}

TEST_CASE("six grids hold the same averages, and correction takes as many grids as it makes") {
  const VoxelFragments list = listOf({{{1, 1, 1}, 0.6f}, {{2, 3, 0}, 0.25f}}, glm::ivec3(4));
  const VoxelAverages one = averagesOf(list), six = averagesOf(list, "six");
  REQUIRE(six.grids.size() == 6);
  for (std::size_t i = 0; i < 6; ++i) CHECK(bytesOf(*six.grids[i]) == bytesOf(*one.grids[0]));
  const auto grids = correctedAs<DirectionalRadianceGrid>("correct_opacity_directional", six);
  const RadianceGrid grid = corrected(one);
  for (const gpu::TextureRef& face : grids.faces) CHECK(face->download(0) == grid.radiance->download(0));
  CHECK_THROWS_WITH(corrected(six), Contains("averages of 6 grids, but expected those of 1"));
  CHECK_THROWS_WITH(correctedAs<DirectionalRadianceGrid>("correct_opacity_directional", one),
                    Contains("averages of 1 grids, but expected those of 6"));
}

TEST_CASE("passes over voxels as draws without attributes give the bits of compute shaders, of any size") {
  const VoxelAverages averages = averagesOf(
      listOf({{{1, 1, 1}, 0.6f}, {{4, 3, 0}, 0.25f}, {{6, 6, 6}, 0.9f}, {{0, 6, 5}, 0.1f}}, glm::ivec3(7)),
      "six");
  VoxelAverages one = averages;
  one.grids.resize(1);
  CHECK(corrected(one, true).radiance->download(0) == corrected(one).radiance->download(0));

  const RadianceGrid compute = mipmapped(corrected(one)), drawn = mipmapped(corrected(one), true);
  CHECK(bytesOf(*compute.radiance) == bytesOf(*drawn.radiance));
  // Sides of three lengths.
  SceneBuilder builder;
  builder.look({0, 0, 2}, {0, 0, 0}, {0, 1, 0}, 0.7, kPixels, kPixels);
  builder.box({-1, -0.3f, -0.5f}, {1, 0.3f, 0.5f}, builder.lambert(0.5f), false);
  InjectSettings settings;
  settings.ambient = 1;
  const RadianceGrid slab = mipmapped(injectedGrid(builder.scene, 24, settings)),
                     drawnSlab = mipmapped(injectedGrid(builder.scene, 24, settings), true);
  REQUIRE(slab.grid.resolution.y != slab.grid.resolution.z);
  CHECK(bytesOf(*slab.radiance) == bytesOf(*drawnSlab.radiance));

  const auto six = mipmapped(correctedAs<DirectionalRadianceGrid>("correct_opacity_directional", averages));
  const auto drawnSix =
      mipmapped(correctedAs<DirectionalRadianceGrid>("correct_opacity_directional", averages, true), true);
  for (std::size_t i = 0; i < 6; ++i) {
    CHECK(bytesOf(*six.faces[i]) == bytesOf(*drawnSix.faces[i]));
    CHECK(six.faces[i]->downloadFloats(2)[3] > 0.0f);
  }
}

TEST_CASE("coarser faces are the children of four columns as seen from either side, and want full cubes") {
  // Along x the column at y = z = 0 holds (red, half opaque) before (green, opaque), a second one green
  // alone; the other two are empty.
  const auto fill = [](int, int x, int y, int z) -> glm::vec4 {
    if (z != 0 || x > 1 || y > 1) return glm::vec4(0.0f);
    if (y == 0) return x == 0 ? glm::vec4(0.5f, 0, 0, 0.5f) : glm::vec4(0, 1, 0, 1);
    return x == 1 ? glm::vec4(0, 1, 0, 1) : glm::vec4(0.0f);
  };
  const DirectionalRadianceGrid grid = mipmapped(makeDirections(4, fill));
  const auto check = [&](int face, const glm::vec4& expected) {
    const glm::vec4 value = faceAt(grid, face, 1, {0, 0, 0});
    CAPTURE(face);
    for (int c = 0; c < 4; ++c) CHECK(value[c] == Approx(expected[c]).margin(1e-6));
  };
  check(1, {0.125f, 0.375f, 0, 0.5f});
  check(0, {0, 0.5f, 0, 0.5f});
  check(3, {0.125f, 0.25f, 0, 0.375f});
  check(2, {0.125f, 0.25f, 0, 0.375f});
  check(4, {0.125f, 0.5f, 0, 0.625f});
  // Nothing but that: where both halve evenly, the levels are those of filter_directional, to the bit.
  const auto noise = [](int face, int x, int y, int z) {
    const float value = static_cast<float>((x * 73 + y * 151 + z * 211 + face / 2 * 37) % 97) / 97.0f;
    return glm::vec4(value * static_cast<float>(face + 1), 0.5f * value, 0.25f * value, value);
  };
  const DirectionalRadianceGrid ours = filteredDirections(makeDirections(16, noise)),
                                printed = mipmapped(makeDirections(16, noise));
  for (std::size_t i = 0; i < 6; ++i) CHECK(bytesOf(*ours.faces[i]) == bytesOf(*printed.faces[i]));

  DirectionalRadianceGrid slab = makeDirections(4, fill);
  slab.grid.resolution.y = 2;
  CHECK_THROWS_WITH(mipmapped(slab), Contains("as many voxels along all axes"));
  DirectionalRadianceGrid coarse = makeDirections(4, fill);
  coarse.finest = coarse.faces[0];
  CHECK_THROWS_WITH(mipmapped(coarse), Contains("six full grids"));
}
