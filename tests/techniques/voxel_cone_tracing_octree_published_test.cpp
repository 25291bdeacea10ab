// The octree as published, worked out by hand for trees of two levels: the averages of the thesis of Gomes
// 2015, the sums of Crassin et al. 2011, and photons by the thesis's Listing 4.24.
#include <cmath>

#include "lumivox/toolkit/light_samples.h"
#include "support/octree.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::cones;
using namespace lumivox::test::octree;

namespace {

// Voxel A = (1,1,1) is the last one of the leaf (0,0,0), so in the corner (2,2,2) of its brick; voxel B the
// first along x of the leaf (1,0,0), in the corner (0,2,2), which is the same place. No other leaf is there.
const glm::ivec3 kA(1, 1, 1), kB(2, 1, 1);
constexpr float kColourA = 0.5f, kColourB = 0.25f;

VoxelFragments twoVoxels(const glm::ivec3& b = kB) {
  return listOf({fragmentAt(kA, glm::vec3(kColourA)), fragmentAt(b, glm::vec3(kColourB))}, glm::ivec3(4));
}

const glm::vec4& at(const std::map<Cell, std::array<glm::vec4, 27>>& bricks, const Cell& brick, int x, int y,
                    int z) {
  return bricks.at(brick)[static_cast<std::size_t>(x + 3 * y + 9 * z)];
}

/// The share that vertex `i` of a brick has of the voxel of a corner along an axis, from 0 to 2: a vertex
/// between two voxels is their mean.
constexpr std::array<double, 3> kLast{0.0, 0.5, 1.0};

/// The root's voxels by the thesis's three passes: of the weights 1, 2, 1 over 4 a centre knows all, and what
/// lies on the border of the tree twice what it knows along each axis across it, since nobody averages it.
/// `alongX`: sums of the leaves' vertices around those of the root along x; along y and z they are those of
/// A.
void checkRoot(const RadianceOctree& octree, const std::array<double, 3>& alongX) {
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

RadianceOctree relit(const VoxelFragments& list, const ReflectiveShadowMap& map,
                     bool treeAsPublished = false) {
  const Scene scene = cones::emptyScene();
  PassHarness splat(device(), techniques(), "voxel_cone_tracing", "octree_splat", scene,
                    snapshotOf(scene, 0.0));
  splat.setParameter("photons_are", std::string("relit"));
  splat.setInput("photons", map);
  splat.setInput("fragments", list);
  splat.setInput("octree", filteredOctree(leavesOf(list, "in_leaves", "float", "own", "one", treeAsPublished),
                                          "average", "averaged"));
  splat.run();
  return splat.output<RadianceOctree>("radiance");
}

}  // namespace

TEST_CASE(
    "by the thesis's passes colours are stored in corners, spread, averaged with neighbours and halved") {
  const RadianceOctree octree = filteredOctree(leavesOf(twoVoxels(), "in_leaves"), "average", "averaged");
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
  const RadianceOctree octree = filteredOctree(leavesOf(twoVoxels(), "at_corners"), "average", "added");
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
                         Row{3, {pi, 3 * pi}, 5.0 / 3.0}, Row{0, {pi}, 0.0}})
    // By ranks, and from the root of a tree that was made depth after depth.
    for (const bool treeAsPublished : {false, true}) {
      const RadianceOctree octree =
          relit(twoVoxels(), photonsOnA(row.photons, row.irradiances), treeAsPublished);
      const double light = mean * row.light;
      const auto leaves = bricksOf(octree, 0);
      CAPTURE(row.photons, row.light, treeAsPublished);
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

TEST_CASE(
    "by Listing 4.24 a surface beside an empty voxel of another leaf is dark: its packed normal is halved") {
  // B lies further off, so that the corner of A is averaged with an empty one: the normal (0, 0, 1), packed
  // as (1/2, 1/2, 1), becomes (1/4, 1/4, 1/2), which unpacks to (-1/2, -1/2, 0), across the light.
  const RadianceOctree octree = relit(twoVoxels({3, 1, 1}), photonsOnA(4, {static_cast<float>(kPi)}));
  for (const auto& [place, voxels] : bricksOf(octree, 0))
    for (const glm::vec4& value : voxels) CHECK(value.x == Approx(0.0).margin(1e-6));
  CHECK(at(bricksOf(octree, 0), {0, 0, 0}, 1, 2, 2).w == Approx(0.5).margin(1e-6));
}

TEST_CASE("relighting is refused without the fragments, and where voxels do not lie in leaves") {
  const Scene scene = cones::emptyScene();
  const VoxelFragments list = twoVoxels();
  const auto refused = [&](const RadianceOctree& octree, bool fragments) {
    PassHarness splat(device(), techniques(), "voxel_cone_tracing", "octree_splat", scene,
                      snapshotOf(scene, 0.0));
    splat.setParameter("photons_are", std::string("relit"));
    splat.setInput("photons", photonsOnA(1, {1.0f}));
    if (fragments) splat.setInput("fragments", list);
    splat.setInput("octree", octree);
    CHECK_THROWS_WITH(splat.run(), Catch::Matchers::Contains("expected the input 'fragments'"));
  };
  refused(filteredOctree(leavesOf(list, "in_leaves"), "average", "averaged"), false);
  refused(filteredOctree(leavesOf(list)), true);
}

TEST_CASE("photons relight all voxels, and refuse fragments that bring their light along") {
  VoxelFragments list = twoVoxels();
  const std::array<std::uint32_t, 2> words{VoxelFragments::kNotKnown, VoxelFragments::kNotKnown};
  list.reflected = std::make_shared<gpu::Buffer>(device(), sizeof(words), "reflected");
  list.reflected->uploadValues(std::span<const std::uint32_t>(words));
  CHECK_THROWS_WITH(relit(list, photonsOnA(1, {static_cast<float>(kPi)})),
                    Catch::Matchers::Contains("octree_splat: input 'fragments' brings along direct light"));
}

TEST_CASE("as published, bricks are read by the hardware's filter, and cones see what they see by hand") {
  // Bricks of their own voxels are always interpolated by hand; filters know 256 places between two texels.
  const glm::ivec3 size(16);
  const VoxelFragments list =
      listOf(fragmentsWhere(size,
                            [](const glm::ivec3& at) {
                              const int sum = at.x + 2 * at.y + 3 * at.z;
                              return sum % 3 == 0 ? glm::vec4(0.1f + 0.1f * (sum % 7), 0.5f, 0.25f, 0.125f)
                                                  : glm::vec4(0.0f);
                            }),
             size);
  const RadianceOctree own = filteredOctree(leavesOf(list)),
                       published = filteredOctree(leavesOf(list, "as_grid", "float", "published"));
  GatherSettings settings;
  settings.asPublished = true;
  for (int i = 0; i < 12; ++i) {
    const glm::vec3 apex(-0.8f + 0.13f * static_cast<float>(i), 0.7f - 0.11f * static_cast<float>(i), 0.1f);
    const glm::vec3 normal = glm::normalize(glm::vec3(i % 3 - 1, i % 2 == 0 ? 1 : -1, i % 5 - 2));
    settings.lookUp = "ranks";
    const glm::vec3 byHand = gather(emptyScene(), own, apex, normal, settings);
    CHECK(glm::length(byHand) > 1e-3f);
    for (const char* lookUp : {"ranks", "descent"}) {
      settings.lookUp = lookUp;
      const glm::vec3 sampled = gather(emptyScene(), published, apex, normal, settings);
      CAPTURE(i, lookUp);
      for (int c = 0; c < 3; ++c) CHECK(sampled[c] == Approx(byHand[c]).epsilon(5e-3));
    }
  }
}
