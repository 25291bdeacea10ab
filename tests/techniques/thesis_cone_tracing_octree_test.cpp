// The bricks of the octree, worked out by hand for trees of two levels and as sums over whole ones: the
// averages of the thesis, the sums of Crassin et al. 2011, photons by Listing 4.24 and cones by Listing 4.25.
#include <cmath>
#include <random>

#include "lumivox/toolkit/light_samples.h"
#include "support/thesis_cone_tracing.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::thesis;

namespace {

// Voxel A = (1,1,1) is the last one of the leaf (0,0,0), so in the corner (2,2,2) of its brick; voxel B the
// first along x of the leaf (1,0,0), in the corner (0,2,2), which is the same place. No other leaf is there.
const glm::ivec3 kA(1, 1, 1), kB(2, 1, 1);
constexpr float kColourA = 0.5f, kColourB = 0.25f;

VoxelFragments twoVoxels(const glm::ivec3& b = kB, float coverage = 1.0f) {
  return listOf({fragmentAt(kA, glm::vec3(kColourA), coverage), fragmentAt(b, glm::vec3(kColourB), coverage)},
                glm::ivec3(4));
}

const glm::vec4& at(const std::map<Cell, Brick>& bricks, const Cell& brick, int x, int y, int z) {
  return bricks.at(brick)[static_cast<std::size_t>(x + 3 * y + 9 * z)];
}

/// The share that vertex `i` of a brick has of the voxel of a corner along an axis, from 0 to 2: a vertex
/// between two voxels is their mean.
constexpr std::array<double, 3> kLast{0.0, 0.5, 1.0};

/// The root's voxels by the thesis's three passes: of the weights 1, 2, 1 over 4 a centre knows all, and what
/// lies on the border of the tree twice what it knows along each axis across it, since nobody averages it.
/// `alongX`: sums of the leaves' vertices around those of the root along x; along y and z they are those of
/// A.
void checkRoot(const OctreeBricks& octree, const std::array<double, 3>& alongX) {
  const auto root = bricksOf(octree, 1);
  REQUIRE(root.size() == 1);
  const std::array<double, 3> across{kLast[0] + kLast[1], kLast[1] + kLast[2], 0.0};
  for (int i = 0; i < 27; ++i) {
    const std::array<std::size_t, 3> v{static_cast<std::size_t>(i % 3), static_cast<std::size_t>(i / 3 % 3),
                                       static_cast<std::size_t>(i / 9)};
    double expected = alongX[v[0]] * across[v[1]] * across[v[2]] / 64.0;
    for (const std::size_t coordinate : v) expected *= coordinate == 1 ? 1.0 : 2.0;
    CAPTURE(v[0], v[1], v[2]);
    CHECK(root.at({0, 0, 0})[static_cast<std::size_t>(i)].x == Approx(expected).margin(1e-6));
  }
}

/// A reflective shadow map of 2 x 2 texels whose first `photons` lie in the middle of voxel A, under lights
/// that shine along -z with these irradiances, in turn.
ReflectiveShadowMap photonsOnA(int photons, const std::vector<float>& irradiances) {
  ReflectiveShadowMap map;
  gpu::TextureDescription description;
  description.kind = gpu::TextureKind::d2Array;
  description.format = gpu::Format::rgba32f;
  description.width = description.height = 2;
  description.depth = 1;
  std::vector<float> position, normal, flux;
  for (int i = 0; i < 4; ++i) {
    const float there = i < photons ? 1.0f : 0.0f;
    position.insert(position.end(), {-0.25f, -0.25f, -0.25f, there});
    normal.insert(normal.end(), {0, 0, 1, there});
    flux.insert(flux.end(), {1, 1, 1, static_cast<float>(static_cast<std::size_t>(i) % irradiances.size())});
  }
  const auto image = [&](const std::vector<float>& values) {
    auto texture = std::make_shared<gpu::Texture>(device(), description, "photons of a test");
    texture->uploadFloats(0, values);
    return texture;
  };
  map.position = image(position);
  map.normal = image(normal);
  map.flux = image(flux);
  std::vector<LightSampleData> lights;
  for (const float irradiance : irradiances) {
    LightSampleData light;
    light.direction = {0, 0, -1};
    light.power = glm::vec3(irradiance);
    lights.push_back(light);
  }
  map.lights = std::make_shared<gpu::Buffer>(device(), lights.size() * sizeof(LightSampleData), "lights");
  map.lights->uploadValues(std::span<const LightSampleData>(lights));
  map.lightCount = static_cast<int>(lights.size());
  map.layerCount = 1;
  return map;
}

OctreeBricks relit(const VoxelFragments& list, const ReflectiveShadowMap& map,
                   const char* voxels = "in_leaves") {
  const Scene scene = cones::emptyScene();
  PassHarness relight = passOf("octree_relight", scene);
  relight.setInput("photons", map);
  relight.setInput("fragments", list);
  relight.setInput("octree", mipmapped(leavesOf(list, voxels)));
  relight.run();
  return relight.output<OctreeBricks>("radiance");
}

}  // namespace

TEST_CASE(
    "by the thesis's passes colours are stored in corners, spread, averaged with neighbours and halved") {
  const OctreeBricks octree = mipmapped(leavesOf(twoVoxels()));
  REQUIRE(octree.tree.depth == 1);
  const auto leaves = bricksOf(octree, 0);
  REQUIRE(leaves.size() == 2);
  const double mean = 0.5 * (kColourA + kColourB);
  for (int i = 0; i < 9; ++i) {
    const int y = i % 3, z = i / 3;
    const double across = kLast[static_cast<std::size_t>(y)] * kLast[static_cast<std::size_t>(z)];
    CAPTURE(y, z);
    CHECK(at(leaves, {0, 0, 0}, 0, y, z).x == 0.0f);
    CHECK(at(leaves, {0, 0, 0}, 1, y, z).x == Approx(0.5 * kColourA * across).margin(1e-6));
    // Both bricks hold the side between them.
    CHECK(at(leaves, {0, 0, 0}, 2, y, z).x == Approx(mean * across).margin(1e-6));
    CHECK(at(leaves, {1, 0, 0}, 0, y, z).x == Approx(mean * across).margin(1e-6));
    CHECK(at(leaves, {1, 0, 0}, 1, y, z).x == Approx(0.5 * kColourB * across).margin(1e-6));
    CHECK(at(leaves, {1, 0, 0}, 2, y, z).x == 0.0f);
  }
  // Around the root's vertices lie the leaves' vertices 0 and 1; 1 and 2, and 0 and 1 of the other leaf;
  // 1 and 2 of that one.
  checkRoot(octree, {0.5 * kColourA, 0.5 * kColourA + mean + mean + 0.5 * kColourB, 0.5 * kColourB});
}

TEST_CASE("by Crassin's passes every fine voxel adds to coarse ones by 1, 2, 1 over 4 along each axis") {
  // Coarse voxel j lies where the finer voxel 2j does: A lies between 0 and 1 along each axis, B on 1 along
  // x.
  const OctreeBricks octree = mipmapped(leavesOf(twoVoxels(), "at_corners"), "added");
  const auto root = bricksOf(octree, 1);
  const std::array<double, 3> alongA{0.25, 0.25, 0.0}, alongB{0.0, 0.5, 0.0};
  for (int i = 0; i < 27; ++i) {
    const auto x = static_cast<std::size_t>(i % 3), y = static_cast<std::size_t>(i / 3 % 3),
               z = static_cast<std::size_t>(i / 9);
    CAPTURE(x, y, z);
    CHECK(root.at({0, 0, 0})[static_cast<std::size_t>(i)].x ==
          Approx((kColourA * alongA[x] + kColourB * alongB[x]) * alongA[y] * alongA[z]).margin(1e-6));
  }
}

TEST_CASE(
    "by Listing 4.24 a photon relights the mean colour of its corner, once however many photons there are") {
  // The corner of A holds the mean of A's and B's colours, and the normal of both faces the light: so A's
  // light is that colour times 1. B has no photon. Spread and averaged with B's empty corner, half is left at
  // the side between them. The first light has the colour 1 (an irradiance of pi), the second one 3: photons
  // of both are averaged.
  const double mean = 0.5 * (kColourA + kColourB);
  struct Row {
    int photons;
    std::vector<float> irradiances;
    double light;
  };
  const float pi = static_cast<float>(kPi);
  for (const Row& row : {Row{1, {pi}, 1.0}, Row{4, {pi}, 1.0}, Row{4, {pi, 3 * pi}, 2.0},
                         Row{3, {pi, 3 * pi}, 5.0 / 3.0}, Row{0, {pi}, 0.0}}) {
    const OctreeBricks octree = relit(twoVoxels(), photonsOnA(row.photons, row.irradiances));
    const double light = mean * row.light;
    const auto leaves = bricksOf(octree, 0);
    CAPTURE(row.photons, row.light);
    for (int i = 0; i < 9; ++i) {
      const int y = i % 3, z = i / 3;
      const double across = kLast[static_cast<std::size_t>(y)] * kLast[static_cast<std::size_t>(z)];
      CHECK(at(leaves, {0, 0, 0}, 1, y, z).x == Approx(0.5 * light * across).margin(1e-6));
      CHECK(at(leaves, {0, 0, 0}, 2, y, z).x == Approx(0.5 * light * across).margin(1e-6));
      CHECK(at(leaves, {1, 0, 0}, 0, y, z).x == Approx(0.5 * light * across).margin(1e-6));
      CHECK(at(leaves, {1, 0, 0}, 1, y, z).x == 0.0f);
      // What is opaque stays so, whether light falls on it or not.
      CHECK(at(leaves, {1, 0, 0}, 1, y, z).w == Approx(0.5 * across).margin(1e-6));
    }
    checkRoot(octree, {0.5 * light, 1.5 * light, 0.0});
  }
}

TEST_CASE("fragments that cover half of their voxels face the light as those that cover all of them") {
  const ReflectiveShadowMap photons = photonsOnA(1, {static_cast<float>(kPi)});
  const auto lightOf = [&](float coverage) {
    return at(bricksOf(relit(twoVoxels(kB, coverage), photons), 0), {0, 0, 0}, 1, 2, 2).x;
  };
  // Their colour counts by half.
  CHECK(lightOf(1.0f) > 0.1f);
  CHECK(lightOf(0.5f) == Approx(0.5f * lightOf(1.0f)).epsilon(1e-4));
}

TEST_CASE(
    "by Listing 4.24 a surface beside an empty voxel of another leaf is dark: its packed normal is halved") {
  // B lies further off, so that the corner of A is averaged with an empty one: the normal (0, 0, 1), packed
  // as (1/2, 1/2, 1), becomes (1/4, 1/4, 1/2), which unpacks to (-1/2, -1/2, 0), across the light.
  const OctreeBricks octree = relit(twoVoxels({3, 1, 1}), photonsOnA(4, {static_cast<float>(kPi)}));
  for (const auto& [place, voxels] : bricksOf(octree, 0))
    for (const glm::vec4& value : voxels) CHECK(value.x == Approx(0.0).margin(1e-6));
  CHECK(at(bricksOf(octree, 0), {0, 0, 0}, 1, 2, 2).w == Approx(0.5).margin(1e-6));
}

TEST_CASE(
    "relighting is refused where voxels do not lie in leaves, and of fragments that bring light along") {
  CHECK_THROWS_WITH(relit(twoVoxels(), photonsOnA(1, {1.0f}), "at_corners"),
                    Catch::Matchers::Contains("expected 'voxels in_leaves'"));
  VoxelFragments list = twoVoxels();
  const OctreeBricks dark = mipmapped(leavesOf(list));
  const std::array<std::uint32_t, 2> words{VoxelFragments::kNotKnown, VoxelFragments::kNotKnown};
  list.reflected = std::make_shared<gpu::Buffer>(device(), sizeof(words), "reflected");
  list.reflected->uploadValues(std::span<const std::uint32_t>(words));
  const auto refused = [](const std::string& pass) {
    return Catch::Matchers::Contains(pass + ": input 'fragments' brings along direct light");
  };
  CHECK_THROWS_WITH(leavesOf(list), refused("octree_leaves"));
  const Scene scene = cones::emptyScene();
  PassHarness relight = passOf("octree_relight", scene);
  relight.setInput("photons", photonsOnA(1, {static_cast<float>(kPi)}));
  relight.setInput("fragments", list);
  relight.setInput("octree", dark);
  CHECK_THROWS_WITH(relight.run(), refused("octree_relight"));
}

TEST_CASE("without lights there are no photons, and the octree stays as it is") {
  const VoxelFragments list = twoVoxels();
  const Scene scene = cones::emptyScene();
  PassHarness relight = passOf("octree_relight", scene);
  const OctreeBricks before = mipmapped(leavesOf(list));
  relight.setInput("fragments", list);
  relight.setInput("octree", before);
  relight.run();
  CHECK(relight.output<OctreeBricks>("radiance").radiance == before.radiance);
}

TEST_CASE("in leaves, the corners of bricks are means of the voxels around them as far as there are leaves") {
  // Two leaves side by side along x, of 2 x 2 x 2 voxels each, all filled with values of their own. Inside,
  // and between them, a vertex is the mean of the 8, 4 or 2 voxels around it; at the outside of those that
  // there are, since an average is taken only with a neighbour that exists.
  const auto value = [](const glm::ivec3& at) {
    return 0.125f * static_cast<float>(1 + at.x % 4 + 2 * (at.y % 2)) / (1.0f + static_cast<float>(at.z % 2));
  };
  const glm::ivec3 low(4, 2, 6), size(4, 2, 2);
  const auto fill = [&](const glm::ivec3& at) {
    const glm::ivec3 in = at - low;
    const bool inside =
        in.x >= 0 && in.y >= 0 && in.z >= 0 && in.x < size.x && in.y < size.y && in.z < size.z;
    return inside ? glm::vec4(glm::vec3(value(at)), 1.0f) : glm::vec4(0.0f);
  };
  const OctreeBricks octree = leavesOf(listOf(fragmentsWhere(glm::ivec3(16), fill), glm::ivec3(16)));
  const auto bricks = bricksOf(octree, 0);
  REQUIRE(bricks.size() == 2);
  for (const auto& [place, values] : bricks)
    for (int i = 0; i < 27; ++i) {
      const glm::ivec3 vertex =
          2 * glm::ivec3(place[0], place[1], place[2]) + glm::ivec3(i % 3, i / 3 % 3, i / 9);
      double sum = 0, count = 0;
      for (int corner = 0; corner < 8; ++corner) {
        const glm::ivec3 at = vertex - glm::ivec3(corner & 1, corner >> 1 & 1, corner >> 2);
        if (fill(at).w == 0.0f) continue;
        sum += value(at);
        ++count;
      }
      CAPTURE(vertex.x, vertex.y, vertex.z);
      CHECK(values[static_cast<std::size_t>(i)].x ==
            Approx(sum / count).epsilon(1e-3));  // albedos are halves
      CHECK(values[static_cast<std::size_t>(i)].w == Approx(1.0).epsilon(1e-5));
    }
}

TEST_CASE("at corners, coarse voxels are means by the weights 1, 2, 1 along each axis") {
  // Of random voxels in the middle of a grid; what a mean misses of them is 0. Parts that are added say so
  // everywhere; parts that are averaged do where all neighbours are there, as in a filled block.
  constexpr int kSize = 16;
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  std::map<Cell, float> values;
  for (const float share : {0.08f, 1.0f}) {
    values.clear();
    const auto fill = [&](const glm::ivec3& at) {
      if (uniform(random) > share) return glm::vec4(0.0f);
      const float value = 0.25f * std::round(1.0f + 3.0f * uniform(random));
      values[cellOf(at)] = value;
      return glm::vec4(glm::vec3(value), 1.0f);
    };
    const OctreeBricks leaves =
        leavesOf(listOf(fragmentsWhere(glm::ivec3(kSize), fill), glm::ivec3(kSize)), "at_corners");
    for (const char* borders : {"added", "averaged"}) {
      const bool averaged = std::string(borders) == "averaged";
      if (averaged && share < 1.0f) continue;
      const OctreeBricks octree = mipmapped(leaves, borders);
      std::map<Cell, float> level = values;
      for (int l = 1; l <= 2; ++l) {
        std::map<Cell, double> coarse;
        for (const auto& [at, value] : level)
          for (int step = 0; step < 27; ++step) {
            const glm::ivec3 d(step % 3 - 1, step / 3 % 3 - 1, step / 9 - 1);
            const glm::ivec3 to(at[0] + d.x, at[1] + d.y, at[2] + d.z);
            if ((to.x & 1) != 0 || (to.y & 1) != 0 || (to.z & 1) != 0) continue;
            coarse[cellOf(to / 2)] +=
                value * (2 - std::abs(d.x)) * (2 - std::abs(d.y)) * (2 - std::abs(d.z)) / 64.0;
          }
        level.clear();
        for (const auto& [at, value] : coarse) level[at] = static_cast<float>(value);
        std::size_t compared = 0;
        for (const auto& [place, brick] : bricksOf(octree, l))
          for (int i = 0; i < 27; ++i) {
            const glm::ivec3 at =
                2 * glm::ivec3(place[0], place[1], place[2]) + glm::ivec3(i % 3, i / 3 % 3, i / 9);
            // At the border of the grid there is no neighbour to average with.
            if (averaged &&
                (at.x % (kSize >> l) == 0 || at.y % (kSize >> l) == 0 || at.z % (kSize >> l) == 0 ||
                 at.x + 1 >= kSize >> l || at.y + 1 >= kSize >> l || at.z + 1 >= kSize >> l))
              continue;
            const auto expected = level.find(cellOf(at));
            CAPTURE(share, borders, l, at.x, at.y, at.z);
            CHECK(brick[static_cast<std::size_t>(i)].x ==
                  Approx(expected == level.end() ? 0.0 : expected->second).margin(2e-4));
            ++compared;
          }
        CHECK(compared > 0);
      }
    }
  }
}

TEST_CASE("parts that are averaged count twice along each axis along which a neighbour is missing") {
  // One voxel in the first brick of all: coarse voxel 0 lies on the border of the grid, where there is no
  // neighbour. Of a voxel at 1 a quarter along each axis belongs to it; as a mean of its own that is a half.
  const VoxelFragments list = listOf({fragmentAt({1, 1, 1}, glm::vec3(1.0f))}, glm::ivec3(8));
  for (const bool averaged : {false, true}) {
    const OctreeBricks octree = mipmapped(leavesOf(list, "at_corners"), averaged ? "averaged" : "added");
    const double axis = averaged ? 0.5 : 0.25;
    const glm::vec4 value = bricksOf(octree, 1).at({0, 0, 0})[0];
    for (int c = 0; c < 4; ++c) CHECK(value[c] == Approx(axis * axis * axis).margin(1e-4));
  }
}

TEST_CASE("what bricks share with their neighbours is the same in all of them, at every level") {
  const glm::ivec3 size(16);
  std::mt19937 random(11);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  const VoxelFragments list = listOf(
      fragmentsWhere(size, [&](const glm::ivec3&) { return glm::vec4(glm::vec3(uniform(random)), 1.0f); }),
      size);
  for (const char* voxels : {"in_leaves", "at_corners"})
    for (const char* borders : {"averaged", "added"}) {
      const OctreeBricks octree = mipmapped(leavesOf(list, voxels), borders);
      for (int level = 0; level < octree.tree.depth; ++level) {
        const auto bricks = bricksOf(octree, level);
        std::size_t wrong = 0, shared = 0;
        for (const auto& [place, values] : bricks)
          for (std::size_t axis = 0; axis < 3; ++axis) {
            Cell next = place;
            ++next[axis];
            const auto neighbour = bricks.find(next);
            if (neighbour == bricks.end()) continue;
            for (int i = 0; i < 9; ++i) {
              std::array<std::size_t, 3> v{};
              v[(axis + 1) % 3] = static_cast<std::size_t>(i % 3);
              v[(axis + 2) % 3] = static_cast<std::size_t>(i / 3);
              const glm::vec4& low = neighbour->second[v[0] + 3 * v[1] + 9 * v[2]];
              v[axis] = 2;
              wrong += values[v[0] + 3 * v[1] + 9 * v[2]] != low ? 1u : 0u;
              ++shared;
            }
          }
        CAPTURE(voxels, borders, level);
        CHECK(shared > 0);
        CHECK(wrong == 0);
      }
    }
}

TEST_CASE("of the pool, the texels in use and the exported voxels are those of the bricks that there are") {
  const glm::ivec3 size(16);
  const VoxelFragments list = listOf(fragmentsWhere(size,
                                                    [](const glm::ivec3& at) {
                                                      return (at.x + 2 * at.y + 3 * at.z) % 7 == 0
                                                                 ? glm::vec4(0.5f, 0.25f, 1.0f, 1.0f)
                                                                 : glm::vec4(0.0f);
                                                    }),
                                     size);
  for (const char* voxels : {"in_leaves", "at_corners"}) {
    const OctreeBricks octree = mipmapped(leavesOf(list, voxels));
    PortContents contents(portKind<OctreeBricks>());
    PortTraits<OctreeBricks>::contents(octree, contents);
    const auto pool = std::find_if(contents.resources().begin(), contents.resources().end(),
                                   [](const PortContents::Resource& is) { return is.texture != nullptr; });
    REQUIRE(pool != contents.resources().end());
    const std::vector<bool> inUse = pool->filled.texels();
    std::size_t bricks = 0;
    for (int level = 0; level < octree.filledLevels; ++level) bricks += octree.tree.bricksOf(level).size();
    CHECK(static_cast<std::size_t>(std::count(inUse.begin(), inUse.end(), true)) == 27 * bricks);
    REQUIRE(contents.fields().size() == 2u * static_cast<std::size_t>(octree.tree.depth + 1));
    const float first = std::string(voxels) == "in_leaves" ? 0.0f : 0.5f;
    for (const PortContents::Field& field : contents.fields()) {
      std::map<Cell, glm::vec4> expected;
      for (const auto& [place, values] : bricksOf(octree, field.level))
        for (int i = 0; i < 8; ++i) {
          const glm::ivec3 local(i & 1, i >> 1 & 1, i >> 2);
          const glm::vec4& value = values[static_cast<std::size_t>(local.x + 3 * local.y + 9 * local.z)];
          if (value.w > 0.0f) expected[cellOf(2 * glm::ivec3(place[0], place[1], place[2]) + local)] = value;
        }
      const auto read = std::get<VoxelsRead>(field.source).read();
      CAPTURE(voxels, field.name, field.level);
      CHECK(read.size() == expected.size());
      for (const auto& [voxel, value] : read)
        CHECK(value.x ==
              (field.name == "opacity" ? expected.at(cellOf(voxel)).w : expected.at(cellOf(voxel)).x));
      // The middle of voxel 0 is the same place at all levels.
      CHECK(field.box.low.x + 0.5 * field.box.voxelSize.x ==
            Approx(octree.tree.grid.low.x + first * octree.tree.grid.voxelSize));
    }
  }
}

TEST_CASE("a uniform medium lets half of its optical depth through in an octree, wherever voxels lie") {
  // Means keep the opacity at all levels. With a cone ratio of 1 the exponents of the samples sum to half of
  // the way in voxels, from 2 to the last one.
  constexpr int kResolution = 64;
  constexpr float kOpacity = 0.25f;
  constexpr double kVoxel = 2.0 / kResolution, kSumOfWeights = 1.0 + 4 * 0.707;
  const glm::ivec3 size(kResolution);
  const VoxelFragments list = listOf(
      fragmentsWhere(size, [](const glm::ivec3&) { return glm::vec4(0.0f, 0.0f, 0.0f, kOpacity); }), size);
  for (const char* voxels : {"in_leaves", "at_corners"})
    for (const char* borders : {"averaged", "added"}) {
      const OctreeBricks octree = mipmapped(leavesOf(list, voxels), borders);
      double distance = 2.0;
      for (int sample = 0; sample < 4; ++sample) distance *= 1.5;
      const double left = gather(cones::emptyScene(glm::vec3(1.0f)), octree, glm::vec3(0.0f), {0, 1, 0},
                                 {.coneRatio = 1.0, .reach = (distance - 0.1) * kVoxel})
                              .r;
      CAPTURE(voxels, borders);
      CHECK(left == Approx(kSumOfWeights * std::pow(1.0 - kOpacity, 0.5 * (distance - 2.0))).epsilon(2e-3));
    }
}

namespace {

constexpr int kResolution = 32;
constexpr double kVoxel = 2.0 / kResolution;

/// An octree whose voxels are all opaque, so that the first sample is all that a cone sees.
OctreeBricks opaque(const char* voxels, const std::function<float(const glm::ivec3&)>& radiance) {
  const glm::ivec3 size(kResolution);
  const VoxelFragments list = listOf(
      fragmentsWhere(size, [&](const glm::ivec3& at) { return glm::vec4(glm::vec3(radiance(at)), 1.0f); }),
      size);
  return mipmapped(leavesOf(list, voxels), std::string(voxels) == "in_leaves" ? "averaged" : "added");
}

}  // namespace

namespace {

/// The first sample of a cone, 2 voxels from its apex, is 2.8 wide: its level is log2 2.8 = 1.485, and the
/// printed blend gives 0.515 to the coarser of two levels, where 0.485 is right.
constexpr double kDiameter = 2.8;
double blended(double level1, double level2) {
  const double share = 1.0 - (std::log2(kDiameter) - 1.0);
  return (1.0 - share) * level1 + share * level2;
}

/// What a cone sees by its first sample, which lies here, of an octree in which all is opaque.
double firstSample(const OctreeBricks& octree, const glm::vec3& at, const glm::vec3& direction) {
  // Of a lobe as wide as the cone.
  const double cosine = 1.0 / std::sqrt(1.0 + 0.25 * std::pow(kDiameter / 2.0, 2)),
               exponent = 1.0 / (1.0 - cosine) - 1.0;
  const glm::vec3 d = glm::normalize(direction);
  return alongDirection(octree, at - static_cast<float>(2.0 * kVoxel) * d, d, static_cast<float>(exponent)).x;
}

}  // namespace

TEST_CASE("a sample between two levels is blended the other way round") {
  // One bright voxel at a corner of all levels has a half of itself along each axis on level 1 and a quarter
  // on level 2.
  constexpr int kBright = kResolution / 2;
  const OctreeBricks octree =
      opaque("at_corners", [](const glm::ivec3& at) { return at == glm::ivec3(kBright) ? 1.0f : 0.0f; });
  const glm::vec3 bright(static_cast<float>((kBright + 0.5) * kVoxel - 1.0));
  CHECK(firstSample(octree, bright, {1, 2, -2}) == Approx(blended(1.0 / 8, 1.0 / 64)).epsilon(2e-3));
}

TEST_CASE("bricks are read by the hardware's filter between their voxels") {
  for (const char* voxels : {"in_leaves", "at_corners"}) {
    const OctreeBricks octree = opaque(voxels, [](const glm::ivec3& at) {
      return 0.1f + 0.1f * static_cast<float>((at.x + 2 * at.y + 3 * at.z) % 7);
    });
    const std::array<std::map<Cell, Brick>, 2> levels{bricksOf(octree, 1), bricksOf(octree, 2)};
    const auto valueAt = [&](const glm::vec3& place, int level) {
      const glm::dvec3 from = ((glm::dvec3(place) + 1.0) / kVoxel - double{octree.tree.firstVoxel()}) /
                              static_cast<double>(1 << level);
      const glm::ivec3 node = glm::ivec3(from) / 2;
      const glm::dvec3 part = from - glm::dvec3(2 * node);
      const glm::ivec3 low = glm::min(glm::ivec3(part), glm::ivec3(1));
      const Brick& brick = levels[static_cast<std::size_t>(level - 1)].at(cellOf(node));
      double value = 0.0;
      for (int corner = 0; corner < 8; ++corner) {
        const glm::ivec3 voxel = low + glm::ivec3(corner & 1, corner >> 1 & 1, corner >> 2);
        const glm::dvec3 weight = 1.0 - glm::abs(part - glm::dvec3(voxel));
        value += weight.x * weight.y * weight.z *
                 brick[static_cast<std::size_t>(voxel.x + 3 * voxel.y + 9 * voxel.z)].x;
      }
      return value;
    };
    for (int i = 0; i < 12; ++i) {
      const glm::vec3 at(0.51f - 0.083f * static_cast<float>(i), 0.057f * static_cast<float>(i) - 0.42f,
                         0.13f);
      CAPTURE(voxels, i);
      // Filters know 256 places between two texels.
      CHECK(firstSample(octree, at, glm::vec3(i % 3 - 1, i % 2 == 0 ? 1 : -1, i % 5 - 2)) ==
            Approx(blended(valueAt(at, 1), valueAt(at, 2))).epsilon(5e-3));
    }
  }
}
