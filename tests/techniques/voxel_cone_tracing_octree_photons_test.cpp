// Photons of a reflective shadow map in the leaves of an octree.
#include <cmath>

#include "support/octree.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::cones;
using namespace lumivox::test::octree;

namespace {

/// A floor of albedo 0.5 in sunlight that falls at a slant, a wall beside it, and a roof over a part of it.
Scene sunlit(int lights) {
  SceneBuilder builder;
  const int grey = builder.lambert(0.5f);
  builder.quad({0, 0, 0}, {0, 0, 2}, {2, 0, 0}, grey);
  builder.quad({0, 0, 0}, {0, 1, 0}, {0, 0, 2}, grey);
  builder.quad({1.3f, 0.6f, 0.2f}, {0, 0, 1}, {0.5f, 0, 0}, grey);
  builder.light(LightKind::directional, glm::vec3(2.0f), {0, 0, 0}, {-0.4f, -1.0f, -0.2f});
  if (lights > 1) builder.light(LightKind::directional, glm::vec3(1.0f), {0, 0, 0}, {-0.1f, -1.0f, 0.3f});
  builder.look({1, 3, 3}, {1, 0, 1}, {0, 1, 0}, 1.0, 16, 16);
  return builder.scene;
}

struct Splat {
  RadianceOctree dark, lit, photons;
};

Splat splatted(const Scene& scene, int resolution, const char* rule) {
  const SceneSnapshot snapshot = snapshotOf(scene, 0.0);
  PassHarness voxels(device(), techniques(), "voxelization", "conservative", scene, snapshot);
  voxels.setParameter("resolution", resolution);
  voxels.run();
  const auto fragments = voxels.output<VoxelFragments>("fragments");
  PassHarness shadow(device(), techniques(), "direct_lighting", "shadow_map", scene, snapshot);
  shadow.run();
  const auto injected = [&](bool lights) {
    PassHarness inject(device(), techniques(), "voxel_cone_tracing", "octree_inject", scene, snapshot);
    inject.setInput("fragments", fragments);
    inject.setInput("tree", treeOf(fragments));
    if (lights) inject.setInput("shadow", shadow.output<ShadowMap>("depth"));
    inject.run();
    return filteredOctree(inject.output<RadianceOctree>("radiance"));
  };
  Splat result{injected(false), injected(true), {}};
  PassHarness map(device(), techniques(), "reflective_shadow_maps", "render", scene, snapshot);
  map.run();
  PassHarness splat(device(), techniques(), "voxel_cone_tracing", "octree_splat", scene, snapshot);
  splat.setParameter("photons_are", std::string(rule));
  splat.setInput("photons", map.output<ReflectiveShadowMap>("map"));
  splat.setInput("octree", result.dark);
  splat.run();
  result.photons = splat.output<RadianceOctree>("radiance");
  return result;
}

double totalOf(const RadianceOctree& octree, int level) {
  double sum = 0.0;
  for (const auto& [voxel, light] : octree.voxels(level, 0)) sum += light.x;
  return sum;
}

}  // namespace

TEST_CASE("photons bring the light that fragments reflect which are lit through a shadow map") {
  for (const int lights : {1, 2})
    for (const char* rule : {"summed", "averaged"}) {
      const Splat splat = splatted(sunlit(lights), 32, rule);
      CAPTURE(lights, rule, totalOf(splat.lit, 0));
      CHECK(totalOf(splat.dark, 0) == 0.0);
      CHECK(totalOf(splat.photons, 0) == Approx(totalOf(splat.lit, 0)).epsilon(0.06));
    }
}

TEST_CASE("in open sunlight a voxel has the radiance albedo / pi times the irradiance") {
  const glm::vec3 sun = glm::normalize(glm::vec3(0.4f, 1.0f, 0.2f));
  const double expected = 0.5 / kPi * 2.0 * sun.y;
  for (const char* rule : {"summed", "averaged"}) {
    const Splat splat = splatted(sunlit(1), 32, rule);
    double sum = 0.0;
    int count = 0;
    for (const auto& [voxel, light] : splat.photons.voxels(0, 0)) {
      // In the middle of the floor, away from the wall and from the roof's shadow.
      if (voxel.y != 1 || voxel.x < 6 || voxel.x > 16 || voxel.z < 21 || voxel.z > 28) continue;
      sum += light.x;
      ++count;
    }
    REQUIRE(count > 20);
    CAPTURE(rule, count);
    CHECK(sum / count == Approx(expected).epsilon(0.05));
  }
}

TEST_CASE("a steep surface meets more voxels for its area, and each gets its share of the flux") {
  // A voxel of width w meets a plane whose distance from its middle is less than (|nx| + |ny| + |nz|) w / 2:
  // an area A meets A (|nx| + |ny| + |nz|) / w^2 of them. The slope's normal is (-1, 1, 0.5) / 1.5, its area
  // 1.5 m^2; each voxel has the radiance albedo / pi times 2 W/m^2 times the cosine.
  SceneBuilder builder;
  const int grey = builder.lambert(0.5f);
  builder.quad({0, 0, 0}, {-0.5f, 0, -1.0f}, {1, 1, 0}, grey);
  builder.light(LightKind::directional, glm::vec3(2.0f), {0, 0, 0}, {0.1f, -1.0f, -0.2f});
  builder.look({1, 3, 3}, {0, 0, 0}, {0, 1, 0}, 1.0, 16, 16);
  const Splat splat = splatted(builder.scene, 48, "summed");
  CHECK(totalOf(splat.lit, 0) == Approx(totalOf(splat.photons, 0)).epsilon(0.05));
  const double voxel = splat.photons.tree.grid.voxelSize,
               cosine = glm::dot(glm::normalize(glm::dvec3(-1, 1, 0.5)),
                                 -glm::normalize(glm::dvec3(0.1, -1, -0.2)));
  CHECK(totalOf(splat.photons, 0) ==
        Approx(0.5 / kPi * 2.0 * cosine * 1.5 * (2.5 / 1.5) / (voxel * voxel)).epsilon(0.05));
}

TEST_CASE(
    "the node map finds every brick that photons change: all levels are those of filtering everything") {
  for (const int lights : {1, 2}) {
    const Splat splat = splatted(sunlit(lights), 32, "summed");
    // Filtered anew in a pool of its own, which the first one is copied to.
    RadianceOctree whole = splat.photons;
    whole.radiance = std::make_shared<gpu::Texture>(device(), splat.photons.radiance->description(), "copy");
    whole.radiance->upload(0, splat.photons.radiance->download(0));
    whole = filteredOctree(whole);
    for (int level = 0; level <= whole.tree.depth; ++level) {
      CAPTURE(lights, level);
      CHECK(totalOf(whole, level) > 0.0);
      CHECK(bricksOf(splat.photons, level) == bricksOf(whole, level));
    }
  }
}

TEST_CASE("photons in an octree without coarser levels, or of six faces, are refused") {
  const Scene scene = sunlit(1);
  PassHarness map(device(), techniques(), "reflective_shadow_maps", "render", scene, snapshotOf(scene, 0.0));
  map.run();
  const VoxelFragments list = listOf({fragmentAt({3, 3, 3})}, glm::ivec3(8));
  const auto refused = [&](const RadianceOctree& octree, const char* why) {
    PassHarness splat(device(), techniques(), "voxel_cone_tracing", "octree_splat", scene,
                      snapshotOf(scene, 0.0));
    splat.setInput("photons", map.output<ReflectiveShadowMap>("map"));
    splat.setInput("octree", octree);
    CHECK_THROWS_WITH(splat.run(), Catch::Matchers::Contains(why));
  };
  refused(leavesOf(list), "expected an octree with all levels");
  refused(filteredOctree(leavesOf(list, "float", "six")), "'faces one'");
}

TEST_CASE("without a light there are no photons, and the octree is dark") {
  Scene scene = sunlit(1);
  scene.lights.clear();
  RenderOptions options;
  options.width = options.height = 16;
  const FrameResult frame = renderOnce(scene, pipeline("voxel_cone_tracing_octree_photons"), options);
  for (const float value : frame.outputs.at("final").values()) CHECK(value == 0.0f);
}
