// Lobes of the normals of lit surfaces: to which side isotropic voxels shine.
#include <cmath>

#include "../../techniques/voxel_cone_tracing/dense/normal_lobes.h"
#include "support/cones.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::cones;
using Catch::Matchers::Contains;
using voxel_cone_tracing::NormalLobes;

namespace {

NormalLobes lobesOf(const Scene& scene, int resolution) {
  const SceneSnapshot snapshot = snapshotOf(scene, 0.0);
  PassHarness voxels(device(), techniques(), "voxelization", "conservative", scene, snapshot);
  voxels.setParameter("resolution", resolution);
  voxels.run();
  PassHarness shadow(device(), techniques(), "direct_lighting", "shadow_map", scene, snapshot);
  shadow.run();
  PassHarness lobes(device(), techniques(), "voxel_cone_tracing", "lobes", scene, snapshot);
  lobes.setInput("fragments", voxels.output<VoxelFragments>("fragments"));
  lobes.setInput("shadow", shadow.output<ShadowMap>("depth"));
  lobes.run();
  return lobes.output<NormalLobes>("lobes");
}

/// All voxels of a level that hold light.
std::vector<glm::vec4> lit(const NormalLobes& lobes, int level) {
  const std::vector<float> texels = lobes.lobes->downloadFloats(level);
  std::vector<glm::vec4> result;
  for (std::size_t i = 0; i < texels.size(); i += 4)
    if (texels[i + 3] > 0.0f) result.push_back({texels[i], texels[i + 1], texels[i + 2], texels[i + 3]});
  return result;
}

/// The single cone of a surface that faces +y: half of the square of the radius, on the way to +z.
const glm::vec3 kAxis(0.0f, 0.70710678f, 0.70710678f);

/// What this cone, 120 degrees wide, sees of a uniform opaque medium of radiance 1 whose voxels have this
/// lobe.
double seen(const glm::vec3& meanNormal, const char* coneLobe = "sine") {
  const RadianceGrid grid = filtered(uniformGrid(16, glm::vec4(1.0f)));
  NormalLobes lobes{grid.grid, uniformGrid(16, 3.0f * glm::vec4(meanNormal, 1.0f)).radiance};
  for (int level = 1; level < lobes.lobes->description().levels; ++level)
    lobes.lobes->clear(3.0f * glm::vec4(meanNormal, 1.0f), level);
  const Scene scene = emptyScene();
  PassHarness harness(device(), techniques(), "voxel_cone_tracing", "gather", scene, snapshotOf(scene, 0.0));
  harness.setParameter("cones", 1);
  harness.setParameter("pattern", 1);
  harness.setParameter("cone_lobe", std::string(coneLobe));
  harness.setInput("gbuffer", surfacePoint(glm::vec3(0.0f), {0, 1, 0}, glm::vec3(1.0f)));
  harness.setInput("grid", grid);
  harness.setInput("lobes", lobes);
  harness.run();
  return imageOf(*harness.output<Image>("diffuse").texture).at(3, 3, 0);
}

double belowNormal(double x) {
  return 0.5 * std::erfc(-x / std::sqrt(2.0));
}

}  // namespace

TEST_CASE("voxels of a sheet know its lit side, whichever way its triangles turn, and how bright it is") {
  for (const double side : {1.0, -1.0}) {
    SceneBuilder builder;
    builder.quad({-1, 0, -1}, {2, 0, 0}, {0, 0, 2}, builder.lambert(0.7f));
    builder.light(LightKind::directional, glm::vec3(2.0f), {}, {0.0f, static_cast<float>(-side), 0.0f});
    builder.look({0, 2, 2}, {0, 0, 0}, {0, 1, 0}, 0.7, kPixels, kPixels);
    const std::vector<glm::vec4> voxels = lit(lobesOf(builder.scene, 16), 0);
    REQUIRE(voxels.size() >= 14 * 14);
    for (const glm::vec4& voxel : voxels) {
      CAPTURE(side, voxel.x, voxel.y, voxel.z, voxel.w);
      CHECK(voxel.w == Approx(2.0 * 0.7 / M_PI).epsilon(0.01));
      CHECK(voxel.y == Approx(side * voxel.w).epsilon(0.002));
    }
  }
}

TEST_CASE(
    "a voxel that shines as much to both sides has no side, and a coarse one the mean of its children") {
  SceneBuilder builder;
  builder.quad({-1, 0.01f, -1}, {2, 0, 0}, {0, 0, 2}, builder.lambert(0.7f));
  builder.quad({-1, -0.01f, -1}, {2, 0, 0}, {0, 0, 2}, builder.lambert(0.7f));
  builder.light(LightKind::directional, glm::vec3(2.0f), {}, {0.0f, -1.0f, 0.0f});
  builder.light(LightKind::directional, glm::vec3(2.0f), {}, {0.0f, 1.0f, 0.0f});
  builder.look({0, 2, 2}, {0, 0, 0}, {0, 1, 0}, 0.7, kPixels, kPixels);
  const NormalLobes lobes = lobesOf(builder.scene, 8);
  glm::vec4 sums[2] = {};
  for (const int level : {0, 1})
    for (const glm::vec4& voxel : lit(lobes, level)) sums[level] += voxel;
  CHECK(std::abs(sums[1].y) < 0.01 * sums[1].w);
  // Half as many along each axis: an eighth of the sum.
  CHECK(sums[1].w == Approx(sums[0].w / 8.0).epsilon(0.001));
  double apart = 0.0;
  for (const glm::vec4& voxel : lit(lobes, 2)) apart = std::max(apart, double(std::abs(voxel.y) / voxel.w));
  CHECK(apart < 0.01);
}

TEST_CASE("lobes are the same bits twice") {
  SceneBuilder builder;
  builder.box({-1, -1, -1}, {1, 1, 1}, builder.lambert(0.7f), true);
  builder.light(LightKind::point, glm::vec3(1.0f), {0.2, 0.1, 0.3});
  builder.look({0, 0, 0.9}, {0, 0, 0}, {0, 1, 0}, 0.7, kPixels, kPixels);
  const NormalLobes a = lobesOf(builder.scene, 32), b = lobesOf(builder.scene, 32);
  for (const int level : {0, 2}) CHECK(a.lobes->downloadFloats(level) == b.lobes->downloadFloats(level));
}

TEST_CASE("a lobe of variance (1 - |D|) / |D| folded with the cone's dims the side that does not shine") {
  // One cone of half angle 60 degrees: its own variance is 3/4, as printed 1/4.
  for (const double length : {1.0, 0.8, 0.4, 0.1})
    for (const double cosine : {1.0, 0.3, 0.0, -0.3, -1.0})
      for (const bool published : {false, true}) {
        const double sine = std::sqrt(1.0 - cosine * cosine);
        // What shines against its axis shines towards the cone.
        const glm::vec3 normal = static_cast<float>(length) * (static_cast<float>(sine) * glm::vec3(1, 0, 0) -
                                                               static_cast<float>(cosine) * kAxis);
        const double x = cosine / std::sqrt((1.0 - length) / length + (published ? 0.25 : 0.75));
        CAPTURE(length, cosine, published);
        CHECK(seen(normal, published ? "cosine" : "sine") ==
              Approx(belowNormal(x) / belowNormal(std::abs(x))).margin(0.002));
      }
  CHECK(seen(glm::vec3(0.0f)) == Approx(1.0).epsilon(1e-4));  // to all sides alike
}

TEST_CASE("lobes for another store than the dense grid are refused with what was expected") {
  const Scene scene = emptyScene();
  PassHarness harness(device(), techniques(), "voxel_cone_tracing", "gather", scene, snapshotOf(scene, 0.0));
  const RadianceGrid grid = uniformGrid(4, glm::vec4(1.0f));
  harness.setInput("gbuffer", surfacePoint(glm::vec3(0.0f), {0, 1, 0}, glm::vec3(1.0f)));
  harness.setInput("directions", makeDirections(4, [](int, int, int, int) { return glm::vec4(1.0f); }));
  harness.setInput("lobes", NormalLobes{grid.grid, grid.radiance});
  CHECK_THROWS_WITH(harness.run(), Contains("'lobes'") && Contains("expected 'grid' to be connected"));
}
