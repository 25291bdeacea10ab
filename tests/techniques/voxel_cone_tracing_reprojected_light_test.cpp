// Direct light that the camera's image has, brought along by reprojected fragments: of the side that was
// seen alone.
#include <array>
#include <glm/gtc/packing.hpp>

#include "lumivox/base/error.h"
#include "support/made_fragments.h"
#include "support/sheets.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::cones;
using Catch::Matchers::Contains;

namespace {

constexpr int kHigherY = 2, kLowerY = 3;
constexpr float kAlbedo = 0.5f, kLit = 0.25f;  // W/(sr m^2): albedo / pi under the sun of pi / 2 W/m^2

/// A roof of one sheet, its triangles facing up or down, under a sun that travels straight down.
Scene roof(bool facesUp, bool seenFromAbove) {
  SceneBuilder builder;
  const int white = builder.lambert(kAlbedo), black = builder.lambert(0.0f);
  if (facesUp)
    builder.quad({-1, 0.53, -1}, {0, 0, 2}, {2, 0, 0}, white);
  else
    builder.quad({-1, 0.53, -1}, {2, 0, 0}, {0, 0, 2}, white);
  builder.quad({-1, -1, -1}, {0, 0, 2}, {2, 0, 0}, black);  // the scene is as high as it is wide
  builder.light(LightKind::directional, glm::vec3(static_cast<float>(kPi) / 2.0f), {}, {0, -1, 0});
  builder.look({0, seenFromAbove ? 2.5 : -0.9, 0}, {0, 0.5, 0}, {0, 0, 1}, 1.0, 64, 64);
  return builder.scene;
}

/// The fragments of what the camera sees, with the direct light of its image.
struct Seen {
  SceneSnapshot snapshot;
  ShadowMap shadow;
  VoxelFragments fragments;
  explicit Seen(const Scene& scene, int resolution = 16) : snapshot(snapshotOf(scene, 0.0)) {
    const auto pass = [&](const char* technique, const char* name) {
      return PassHarness(device(), techniques(), technique, name, scene, snapshot);
    };
    PassHarness gbuffer = pass("direct_lighting", "gbuffer"), maps = pass("direct_lighting", "shadow_map"),
                shade = pass("direct_lighting", "shade"), reproject = pass("voxelization", "reproject");
    gbuffer.run();
    maps.run();
    shadow = maps.output<ShadowMap>("depth");
    shade.setInput("gbuffer", gbuffer.output<GBuffer>("gbuffer"));
    shade.setInput("shadow", shadow);
    shade.run();
    reproject.setParameter("resolution", resolution);
    reproject.setInput("gbuffer", gbuffer.output<GBuffer>("gbuffer"));
    reproject.setInput("direct", shade.output<Image>("radiance"));
    reproject.run();
    fragments = reproject.output<VoxelFragments>("fragments");
  }
};

template <class Port>
Port injectedInto(const Scene& scene, const Seen& seen, const char* pass) {
  PassHarness inject(device(), techniques(), "voxel_cone_tracing", pass, scene, seen.snapshot);
  inject.setInput("fragments", seen.fragments);
  inject.setInput("shadow", seen.shadow);
  if (std::is_same_v<Port, octree::RadianceOctree>) {
    inject.setInput("tree", octree::treeOf(seen.fragments));
    inject.setParameter("faces", std::string("six"));
  }
  inject.run();
  return inject.template output<Port>("radiance");
}

/// The voxel of the roof nearest to the middle of the grid.
glm::ivec3 middleOf(const VoxelFragments& list) {
  glm::ivec3 nearest(1 << 20);
  const auto away = [&](const glm::ivec3& cell) {
    return std::abs(cell.x - list.grid.resolution.x / 2) + std::abs(cell.z - list.grid.resolution.z / 2);
  };
  for (const FragmentData& fragment : fragmentsOf(list))
    if (fragment.albedo().r > 0.0f && away(fragment.cell()) < away(nearest)) nearest = fragment.cell();
  return nearest;
}

}  // namespace

TEST_CASE("a sunlit roof of one sheet shines upwards and its underside is dark, from wherever it is seen") {
  // From above the image has the light of the sunlit side; from below it has the underside, which is black,
  // and the sun shines on the other side all the same. The voxels of one grid shine to all sides alike.
  const bool facesUp = GENERATE(true, false), above = GENERATE(true, false);
  CAPTURE(facesUp, above);
  const Scene scene = roof(facesUp, above);
  const Seen seen(scene);
  REQUIRE(seen.fragments.reflected != nullptr);
  const glm::ivec3 voxel = middleOf(seen.fragments);

  const auto six = injectedInto<DirectionalRadianceGrid>(scene, seen, "inject_directional");
  CHECK(faceAt(six, kHigherY, 0, voxel).r == Approx(kLit).epsilon(0.01));
  CHECK(faceAt(six, kLowerY, 0, voxel).r == 0.0f);
  CHECK(faceAt(six, kLowerY, 0, voxel).a == 1.0f);

  const auto tree = injectedInto<octree::RadianceOctree>(scene, seen, "octree_inject");
  const glm::ivec3 local = voxel & 1, place = voxel / 2;
  const auto faceOf = [&](int face) {
    return octree::bricksOf(tree, 0, face)
        .at(octree::cellOf(place))[static_cast<std::size_t>(local.x + 3 * local.y + 9 * local.z)];
  };
  CHECK(faceOf(kHigherY).r == Approx(kLit).epsilon(0.01));
  CHECK(faceOf(kLowerY).r == 0.0f);
  CHECK(faceOf(kLowerY).a == 1.0f);

  const auto one = injectedInto<RadianceGrid>(scene, seen, "inject");
  const std::vector<float> texels = one.radiance->downloadFloats(0);
  const glm::ivec3 size = one.grid.resolution;
  const auto at = static_cast<std::size_t>((voxel.z * size.y + voxel.y) * size.x + voxel.x);
  CHECK(texels[4 * at] == Approx(kLit).epsilon(0.01));
}

TEST_CASE("what is known of a fragment's back is not light of its front, and off with 'two_sided off'") {
  // 192 / 256 W/(sr m^2) at the front of the first fragment and behind the second one. No lights.
  constexpr std::uint32_t kSeenBehind = 1u << 30, kKnown = 192u | 192u << 8 | 192u << 16 | 128u << 24;
  std::vector<FragmentData> fragments{octree::fragmentAt({1, 1, 2}), octree::fragmentAt({2, 1, 2})};
  for (FragmentData& fragment : fragments) fragment.normal = packedOctahedron({0, 1, 0});
  fragments[1].offset |= kSeenBehind;
  VoxelFragments list = octree::listOf(fragments, glm::ivec3(8));
  const std::array<std::uint32_t, 2> words{kKnown, kKnown};
  list.reflected = std::make_shared<gpu::Buffer>(device(), sizeof(words), "reflected");
  list.reflected->uploadValues(std::span<const std::uint32_t>(words));
  const Scene scene = emptyScene();
  for (const bool twoSided : {true, false}) {
    PassHarness inject(device(), techniques(), "voxel_cone_tracing", "inject_directional", scene,
                       snapshotOf(scene, 0.0));
    inject.setInput("fragments", list);
    inject.setParameter("two_sided", std::string(twoSided ? "on" : "off"));
    inject.setParameter("ambient", kPi);  // each side reflects its albedo, 0.5
    inject.run();
    const auto grid = inject.output<DirectionalRadianceGrid>("radiance");
    CAPTURE(twoSided);
    CHECK(faceAt(grid, kHigherY, 0, {1, 1, 2}).r == Approx(0.75 + 0.5).epsilon(1e-3));
    CHECK(faceAt(grid, kLowerY, 0, {1, 1, 2}).r == Approx(0.5).epsilon(1e-3));
    CHECK(faceAt(grid, kHigherY, 0, {2, 1, 2}).r == Approx(0.5).epsilon(1e-3));
    CHECK(faceAt(grid, kLowerY, 0, {2, 1, 2}).r == Approx(twoSided ? 0.75 + 0.5 : 0.5).epsilon(1e-3));
  }
}

TEST_CASE("injections that light all fragments themselves refuse those that bring their light along") {
  const Scene scene = roof(true, true);
  const Seen seen(scene);
  for (const auto& [technique, name] :
       {std::pair("thesis_cone_tracing", "inject"), {"light_propagation_volumes", "inject_voxels"}}) {
    PassHarness inject(device(), techniques(), technique, name, scene, seen.snapshot);
    inject.setInput("fragments", seen.fragments);
    inject.setInput("shadow", seen.shadow);
    CHECK_THAT(messageOf<Error>([&] { inject.run(); }), Contains(name) &&
                                                            Contains("brings along direct light") &&
                                                            Contains("'direct'") && Contains("left out"));
  }
}
