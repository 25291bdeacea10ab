// Averages over the fragments of a voxel: closed forms, whatever the order of the list.
#include <cmath>
#include <random>

#include "lumivox/toolkit/light_samples.h"
#include "support/made_fragments.h"
#include "support/passes.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

constexpr int kSide = 8;

/// A fragment at the centre of a voxel.
FragmentData fragment(const glm::ivec3& cell, const glm::vec3& albedo, float coverage,
                      const glm::vec3& normal, std::uint32_t emission = 0) {
  FragmentData result = squareAt((glm::dvec3(cell) + 0.5) / 2.0, normal, albedo, coverage);
  result.emission = emission;
  return result;
}

/// The radiance `value` in all channels, a power of two: mantissa 128 of 256 beside an exponent.
std::uint32_t sharedExponent(float value) {
  const auto exponent = static_cast<std::uint32_t>(std::lround(std::log2(value)) + 1 + 128);
  return 128u | 128u << 8 | 128u << 16 | exponent << 24;
}

/// Dispatched in `columns` by `rows` groups; without columns in one row.
VoxelFragments listOf(const std::vector<FragmentData>& fragments, VoxelFragments::Coverage rule,
                      std::uint32_t columns = 0, std::uint32_t rows = 1) {
  VoxelFragments list;
  list.grid = {glm::vec3(0.0f), 1.0f / kSide, glm::ivec3(kSide, kSide - 1, kSide - 2)};
  list.capacity = fragments.size();
  list.coverage = rule;
  list.fragments = bufferOf(fragments);
  const auto count = static_cast<std::uint32_t>(fragments.size());
  list.count =
      bufferOf<std::uint32_t>({count, columns > 0 ? columns : std::max(1u, (count + 63) / 64), rows, 1});
  return list;
}

Scene sceneThatEmits(float radiance) {
  SceneBuilder builder;
  builder.quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, builder.lambert(0.5f, radiance));
  return builder.scene;
}

struct Averages {
  std::vector<float> albedo, normal, emission, opacity;
  std::set<Cell> bits;

  static Averages of(const AttributeGrid& attributes, const OccupancyGrid& opacity, const BinaryGrid& bits) {
    return {attributes.albedo->downloadFloats(), attributes.normal->downloadFloats(),
            attributes.emission ? attributes.emission->downloadFloats() : std::vector<float>{},
            opacity.opacity->downloadFloats(), cellsOf(bits)};
  }
  static std::size_t at(const glm::ivec3& cell) {
    return static_cast<std::size_t>((cell.z * (kSide - 1) + cell.y) * kSide + cell.x);
  }
  static glm::vec4 texel(const std::vector<float>& values, const glm::ivec3& cell) {
    const float* first = values.data() + 4 * at(cell);
    return {first[0], first[1], first[2], first[3]};
  }
  bool operator==(const Averages&) const = default;
};

Averages averagesOf(const Scene& scene, const std::vector<FragmentData>& fragments,
                    VoxelFragments::Coverage rule = VoxelFragments::Coverage::mean, std::uint32_t columns = 0,
                    std::uint32_t rows = 1) {
  LonePass pass("voxelization.average", scene);
  pass.in("fragments", listOf(fragments, rule, columns, rows));
  return Averages::of(pass.out<AttributeGrid>("attributes"), pass.out<OccupancyGrid>("opacity"),
                      pass.out<BinaryGrid>("bits"));
}

const glm::vec3 kUp(0, 0, 1);

}  // namespace

TEST_CASE(
    "albedo, emission and normal are means weighted by coverage, and the mean coverage is the opacity") {
  const glm::ivec3 cell(3, 2, 5);
  // Weights 1 and 1/4: albedo (0.8 + 0.25 * 0.4) / 1.25 = 0.72; emission (4 + 0.25 * 8) / 1.25 = 4.8.
  const Averages averages = averagesOf(
      sceneThatEmits(8.0f), {fragment(cell, {0.8f, 0.5f, 0.0f}, 1.0f, kUp, sharedExponent(4.0f)),
                             fragment(cell, {0.4f, 0.5f, 1.0f}, 0.25f, {1, 0, 0}, sharedExponent(8.0f))});
  const glm::vec4 albedo = Averages::texel(averages.albedo, cell),
                  normal = Averages::texel(averages.normal, cell),
                  emission = Averages::texel(averages.emission, cell);
  CHECK(albedo.x == Approx(0.72).epsilon(1e-3));
  CHECK(albedo.y == Approx(0.5).epsilon(1e-3));
  CHECK(albedo.z == Approx(0.2).epsilon(1e-3));
  CHECK(albedo.w == Approx(0.625).epsilon(1e-3));
  CHECK(normal.x == Approx(0.2).epsilon(1e-3));
  CHECK(normal.z == Approx(0.8).epsilon(1e-3));
  CHECK(emission.x == Approx(4.8).epsilon(1e-3));
  CHECK(averages.opacity[Averages::at(cell)] == Approx(0.625).margin(0.5 / 255));
  CHECK(averages.bits == std::set<Cell>{{3, 2, 5}});
}

TEST_CASE("the mean over more fragments of one voxel than 16 bits count is exact, of equals to the bit") {
  const glm::ivec3 cell(2, 3, 4);
  std::vector<FragmentData> fragments;
  // 30 % dark and 70 % bright, facing two ways: the means are (0.3 * 0.125 + 0.7 * 0.75) = 0.5625 and halves.
  constexpr int kCount = 100000;
  for (int i = 0; i < kCount; ++i) {
    const bool dark = i % 10 < 3, up = i % 2 == 0;
    fragments.push_back(fragment(cell, glm::vec3(dark ? 0.125f : 0.75f), 1.0f,
                                 up ? glm::vec3(0, 0, 1) : glm::vec3(1, 0, 0),
                                 sharedExponent(dark ? 1.0f : 8.0f)));
  }
  const Averages averages = averagesOf(sceneThatEmits(8.0f), fragments);
  const glm::vec4 albedo = Averages::texel(averages.albedo, cell);
  CHECK(albedo.x == Approx(0.5625).epsilon(1e-3));
  CHECK(albedo.w == 1.0f);
  CHECK(Averages::texel(averages.normal, cell).x == Approx(0.5).epsilon(1e-3));
  CHECK(Averages::texel(averages.normal, cell).z == Approx(0.5).epsilon(1e-3));
  CHECK(Averages::texel(averages.emission, cell).x == Approx(5.9).epsilon(1e-3));
  // Values common to all fragments are rounded alike above and below the fraction.
  fragments.assign(kCount, fragment(cell, glm::vec3(0.25f), 1.0f, kUp, sharedExponent(2.0f)));
  CHECK(Averages::texel(averagesOf(sceneThatEmits(2.0f), fragments).emission, cell).x ==
        Approx(2.0).epsilon(1e-6));
}

TEST_CASE("coverages of parts of a voxel add up, to one at most") {
  std::vector<FragmentData> fragments;
  const glm::ivec3 few(1, 1, 1), many(2, 1, 1);
  for (int i = 0; i < 3; ++i) fragments.push_back(fragment(few, {0.6f, 0.6f, 0.6f}, 0.125f, kUp));
  for (int i = 0; i < 40; ++i) fragments.push_back(fragment(many, {0.3f, 0.3f, 0.3f}, 0.125f, kUp));
  const Averages sum = averagesOf(sceneThatEmits(1.0f), fragments, VoxelFragments::Coverage::sum);
  CHECK(Averages::texel(sum.albedo, few).w == Approx(0.375).epsilon(1e-3));
  CHECK(Averages::texel(sum.albedo, few).x == Approx(0.6).epsilon(1e-3));
  CHECK(Averages::texel(sum.albedo, many).w == 1.0f);
  CHECK(Averages::texel(sum.albedo, many).x == Approx(0.3).epsilon(1e-3));
  const Averages mean = averagesOf(sceneThatEmits(1.0f), fragments);
  CHECK(Averages::texel(mean.albedo, few).w == Approx(0.125).epsilon(1e-3));
  CHECK(Averages::texel(mean.albedo, many).w == Approx(0.125).epsilon(1e-3));
}

TEST_CASE("opposite normals cancel, and where they agree the mean has unit length") {
  const glm::ivec3 thin(4, 4, 4), flat(5, 4, 4);
  const Averages averages = averagesOf(
      sceneThatEmits(1.0f),
      {fragment(thin, glm::vec3(0.5f), 1.0f, {1, 0, 0}), fragment(thin, glm::vec3(0.5f), 1.0f, {-1, 0, 0}),
       fragment(flat, glm::vec3(0.5f), 0.5f, {0, 1, 0}), fragment(flat, glm::vec3(0.5f), 1.0f, {0, 1, 0})});
  CHECK(glm::length(glm::vec3(Averages::texel(averages.normal, thin))) < 1e-4f);
  CHECK(glm::length(glm::vec3(Averages::texel(averages.normal, flat))) == Approx(1.0).epsilon(1e-3));
}

TEST_CASE("the mean of one normal is that normal, whichever way it points") {
  std::vector<FragmentData> fragments;
  std::vector<glm::vec3> normals;
  for (int i = 0; i < 8; ++i) {
    const glm::vec3 signs(i & 1 ? -1.0f : 1.0f, i & 2 ? -1.0f : 1.0f, i & 4 ? -1.0f : 1.0f);
    normals.push_back(signs * glm::normalize(glm::vec3(1, 2, 3)));
    fragments.push_back(fragment({i & 1, i >> 1 & 1, i >> 2}, glm::vec3(0.5f), 1.0f, normals.back()));
  }
  const Averages averages = averagesOf(sceneThatEmits(1.0f), fragments);
  for (int i = 0; i < 8; ++i) {
    const glm::vec4 found = Averages::texel(averages.normal, {i & 1, i >> 1 & 1, i >> 2});
    for (int c = 0; c < 3; ++c)
      CHECK(found[c] == Approx(normals[static_cast<std::size_t>(i)][c]).margin(1e-3));
  }
}

TEST_CASE(
    "every fragment of a list has its part in the averages, in however many rows of groups it is dispatched") {
  std::vector<FragmentData> fragments;
  for (int i = 0; i < 300; ++i)
    fragments.push_back(fragment({i % kSide, i / kSide % 7, i / (kSide * 7)},
                                 glm::vec3(0.25f + 0.002f * static_cast<float>(i)), 1.0f, kUp,
                                 sharedExponent(1.0f)));
  const Scene scene = sceneThatEmits(1.0f);
  constexpr auto kMean = VoxelFragments::Coverage::mean;
  const Averages row = averagesOf(scene, fragments);
  CHECK(row.bits.size() == fragments.size());
  for (int i = 0; i < 300; ++i)
    CHECK(row.albedo[4 * static_cast<std::size_t>(i)] == Approx(0.25 + 0.002 * i).epsilon(1e-3));
  CHECK(averagesOf(scene, fragments, kMean, 3, 2) == row);
  CHECK(averagesOf(scene, fragments, kMean, 2, 4) == row);
  CHECK(averagesOf(scene, fragments, kMean, 1, 5) == row);
}

TEST_CASE("averages do not depend on the order of the list, to the bit") {
  std::mt19937 generator(5);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  std::vector<FragmentData> fragments;
  for (int i = 0; i < 5000; ++i) {
    const glm::ivec3 cell(glm::vec3(uniform(generator), uniform(generator), uniform(generator)) * 3.9f);
    fragments.push_back(fragment(cell, {uniform(generator), uniform(generator), uniform(generator)},
                                 uniform(generator), {uniform(generator), uniform(generator), 0.1f},
                                 sharedExponent(std::exp2(std::floor(uniform(generator) * 5.0f)))));
  }
  const Scene scene = sceneThatEmits(16.0f);
  for (const auto rule : {VoxelFragments::Coverage::mean, VoxelFragments::Coverage::sum}) {
    const Averages first = averagesOf(scene, fragments, rule);
    std::shuffle(fragments.begin(), fragments.end(), generator);
    CHECK(averagesOf(scene, fragments, rule) == first);
  }
}

TEST_CASE("a dim crowded voxel keeps its emission in a grid with an area light 10^12 times as bright") {
  // Every voxel has a unit of its own: 5000 fragments of radiance 1 and half as many of 1/4 have the mean
  // 3/4.
  const glm::ivec3 dim(1, 2, 3), bright(6, 2, 3);
  for (const float brightest : {0x1p0f, 0x1p20f, 0x1p40f}) {
    std::vector<FragmentData> fragments{
        fragment(bright, glm::vec3(0.5f), 1.0f, kUp, sharedExponent(brightest))};
    for (int i = 0; i < 7500; ++i)
      fragments.push_back(
          fragment(dim, glm::vec3(0.5f), 1.0f, kUp, sharedExponent(i % 3 == 0 ? 0.25f : 1.0f)));
    const Averages averages = averagesOf(sceneThatEmits(brightest), fragments);
    INFO("brightest " << brightest);
    CHECK(Averages::texel(averages.emission, dim).x == Approx(0.75).epsilon(1e-4));
    CHECK(Averages::texel(averages.emission, bright).x == Approx(brightest).epsilon(1e-4));
  }
}

TEST_CASE("coloured emission keeps its colour, whichever channel is the brightest") {
  std::vector<FragmentData> fragments;
  for (int i = 0; i < 6; ++i) {
    // Mantissas 32, 64 and 128 of 256 in all orders, beside the exponent of 2: radiances 1/2, 1 and 2.
    const std::uint32_t r = 32u << i % 3, g = 32u << (i < 3 ? i + 1 : i + 2) % 3, b = 32u * 7u - r - g;
    fragments.push_back(
        fragment({i, 0, 0}, glm::vec3(0.5f), 1.0f, kUp, r | g << 8 | b << 16 | (2u + 128u) << 24));
  }
  const Averages averages = averagesOf(sceneThatEmits(2.0f), fragments);
  for (int i = 0; i < 6; ++i) {
    const glm::vec4 found = Averages::texel(averages.emission, {i, 0, 0});
    for (int c = 0; c < 3; ++c) {
      const std::uint32_t mantissa = fragments[static_cast<std::size_t>(i)].emission >> 8 * c & 255u;
      CHECK(found[c] == Approx(mantissa / 64.0).epsilon(1e-5));
    }
  }
}

TEST_CASE("a grid of several stacks along z has every voxel's bit in its own") {
  std::vector<FragmentData> fragments;
  std::set<Cell> expected;
  for (const int z : {0, 31, 32, 127, 128, 200, 255, 256, 300, 383, 384, 399}) {
    fragments.push_back(fragment({z % 3, z % 2, z}, glm::vec3(0.5f), 1.0f, kUp));
    expected.insert({z % 3, z % 2, z});
  }
  VoxelFragments list = listOf(fragments, VoxelFragments::Coverage::mean);
  list.grid.resolution = {3, 2, 400};
  CHECK(cellsOf(LonePass("voxelization.average", SceneBuilder().scene)
                    .in("fragments", list)
                    .out<BinaryGrid>("bits")) == expected);
}

TEST_CASE("an empty list gives empty grids, and a scene that emits nothing no emission") {
  const Averages empty = averagesOf(sceneThatEmits(1.0f), {});
  CHECK(empty.bits.empty());
  CHECK(std::all_of(empty.albedo.begin(), empty.albedo.end(), [](float value) { return value == 0.0f; }));
  const Averages dark = averagesOf(sceneThatEmits(0.0f), {fragment({1, 1, 1}, glm::vec3(0.5f), 1.0f, kUp)});
  CHECK(dark.emission.empty());
}

TEST_CASE("the averages of a voxelized scene have its albedo and its voxels") {
  SceneBuilder builder;
  builder.box({-1, -1, -1}, {1, 1, 1}, builder.lambert(0.25f, 3.0f), false);
  LonePass pass("voxelization.average", builder.scene);
  pass.in("fragments", fragmentsIn(builder.scene, {{"resolution", 16}}));
  const Averages averages = Averages::of(pass.out<AttributeGrid>("attributes"),
                                         pass.out<OccupancyGrid>("opacity"), pass.out<BinaryGrid>("bits"));
  // One empty voxel around a box of 14 voxels a side: its shell.
  CHECK(averages.bits.size() == 14u * 14u * 14u - 12u * 12u * 12u);
  std::size_t occupied = 0;
  for (std::size_t i = 0; i < averages.opacity.size(); ++i) {
    if (averages.opacity[i] == 0.0f) continue;
    ++occupied;
    CHECK(averages.opacity[i] == 1.0f);
    CHECK(averages.albedo[4 * i] == Approx(0.25).epsilon(1e-3));
    CHECK(averages.emission[4 * i + 1] == Approx(3.0).epsilon(5e-3));
  }
  CHECK(occupied == averages.bits.size());
}

TEST_CASE("the grid of cone tracing takes coverages by the rule of the list") {
  // Three fragments of a quarter each, lit from the front by 2 pi W/m^2: radiance 2 albedo = 1.2 where
  // covered.
  SceneBuilder builder;
  builder.quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, builder.lambert(0.5f));
  builder.light(LightKind::directional, glm::vec3(2.0f * static_cast<float>(kPi)), {0, 0, 0}, {0, 0, -1});
  LightSampleData sun{};
  sun.direction = {0, 0, -1};
  sun.firstView = -1;
  sun.power = glm::vec3(2.0f * static_cast<float>(kPi));
  ShadowMap shadow;
  shadow.lightCount = shadow.layerCount = 1;
  shadow.lights = bufferOf<LightSampleData>({sun});
  shadow.views = bufferOf<glm::mat4>({glm::mat4(1.0f)});
  shadow.depth = filled({gpu::TextureKind::d2Array, gpu::Format::depth32f}, glm::vec4(1.0f));
  const glm::ivec3 cell(2, 2, 2);
  const std::vector<FragmentData> fragments(3, fragment(cell, glm::vec3(0.6f), 0.25f, kUp));
  for (const auto rule : {VoxelFragments::Coverage::mean, VoxelFragments::Coverage::sum}) {
    const RadianceGrid grid = LonePass("voxel_cone_tracing.inject", builder.scene)
                                  .in("fragments", listOf(fragments, rule))
                                  .in("shadow", shadow)
                                  .out<RadianceGrid>("radiance");
    const auto values = grid.radiance->downloadFloats();
    const glm::ivec3 size = grid.grid.resolution;  // may be larger than the list's
    const float* texel =
        values.data() + 4 * static_cast<std::size_t>((cell.z * size.y + cell.y) * size.x + cell.x);
    const glm::vec4 voxel(texel[0], texel[1], texel[2], texel[3]);
    const double opacity = rule == VoxelFragments::Coverage::sum ? 0.75 : 0.25;
    CHECK(voxel.w == Approx(opacity).epsilon(1e-4));
    CHECK(voxel.x == Approx(1.2 * opacity).epsilon(2e-3));
  }
}

namespace {

std::set<Cell> bitsOf(const std::vector<FragmentData>& fragments, VoxelFragments::Coverage rule,
                      const char* masks, std::uint64_t seed = 1) {
  return cellsOf(LonePass("voxelization.average", SceneBuilder().scene, {{"masks", masks}})
                     .in("fragments", listOf(fragments, rule))
                     .run(seed)
                     .out<BinaryGrid>("bits"));
}

}  // namespace

TEST_CASE("voxels with holes are set always, from half their cover on, or by chance") {
  const std::vector<FragmentData> fragments{
      fragment({1, 1, 1}, glm::vec3(0.5f), 0.4f, kUp), fragment({2, 1, 1}, glm::vec3(0.5f), 0.5f, kUp),
      fragment({3, 1, 1}, glm::vec3(0.5f), 1.0f, kUp), fragment({4, 1, 1}, glm::vec3(0.5f), 0.0f, kUp),
      fragment({5, 1, 1}, glm::vec3(0.5f), 0.3f, kUp), fragment({5, 1, 1}, glm::vec3(0.5f), 0.3f, kUp)};
  using Coverage = VoxelFragments::Coverage;
  const std::set<Cell> all{{1, 1, 1}, {2, 1, 1}, {3, 1, 1}, {4, 1, 1}, {5, 1, 1}};
  CHECK(bitsOf(fragments, Coverage::mean, "any") == all);
  CHECK(bitsOf(fragments, Coverage::sum, "any") == all);
  // Of a list whose fragments are judged one by one the two in the last voxel cover 0.3; else 0.6.
  CHECK(bitsOf(fragments, Coverage::mean, "half") == std::set<Cell>{{2, 1, 1}, {3, 1, 1}});
  CHECK(bitsOf(fragments, Coverage::sum, "half") == std::set<Cell>{{2, 1, 1}, {3, 1, 1}, {5, 1, 1}});
  for (std::uint64_t seed = 1; seed < 20; ++seed)
    for (const Coverage rule : {Coverage::mean, Coverage::sum}) {
      const std::set<Cell> chosen = bitsOf(fragments, rule, "random", seed);
      CHECK(chosen.contains({3, 1, 1}));
      CHECK_FALSE(chosen.contains({4, 1, 1}));
    }
}

TEST_CASE("by chance as many voxels of a lattice are set as it covers, others with another seed") {
  for (const float cover : {0.25f, 0.7f})
    for (const auto rule : {VoxelFragments::Coverage::mean, VoxelFragments::Coverage::sum}) {
      std::vector<FragmentData> lattice;
      for (int i = 0; i < kSide * (kSide - 1) * (kSide - 2); ++i)
        lattice.push_back(fragment({i % kSide, i / kSide % (kSide - 1), i / kSide / (kSide - 1)},
                                   glm::vec3(0.5f), cover, kUp));
      double set = 0.0;
      std::set<Cell> before;
      for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        const std::set<Cell> chosen = bitsOf(lattice, rule, "random", seed);
        set += static_cast<double>(chosen.size()) / static_cast<double>(lattice.size()) / 10.0;
        CHECK(chosen != before);
        before = chosen;
        std::reverse(lattice.begin(), lattice.end());
        CHECK(bitsOf(lattice, rule, "random", seed) == chosen);  // whatever their order
      }
      // 3360 voxels: four standard deviations are 0.03; of the sums coverage has eight bits.
      CHECK(set == Approx(cover).margin(0.035));
    }
}
