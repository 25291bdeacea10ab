// Paths whose rays end at the surface within a voxel: closed forms in rooms of triangles, and what is left as
// it is.
#include <cmath>

#include "lumivox/base/error.h"
#include "support/facts.h"
#include "support/form_factors.h"
#include "support/voxel_fragments.h"
#include "support/voxel_paths.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::near_field;
using namespace lumivox::test::voxel_paths;

namespace {

const Settings kPlanes{{"stop", "plane"}, {"offset", 0.5}};

/// A scene in voxels.
struct Voxelized {
  Voxelized(const SceneBuilder& builder, int resolution)
      : scene(builder.scene), origin(snapshotOf(scene, 0.0).origin) {
    fragments = fragmentsIn(scene, {{"resolution", resolution}});
    LonePass average("voxelization.average", scene);
    average.in("fragments", fragments);
    bits = average.out<BinaryGrid>("bits");
    attributes = average.out<AttributeGrid>("attributes");
  }
  /// Paths from a place of the scene.
  Gatherer tracerAt(const glm::dvec3& place, const glm::dvec3& normal) const {
    Gatherer result = tracer(bits, glm::vec3(place - origin), glm::vec3(normal), scene);
    result.in("fragments", fragments);
    result.in("attributes", attributes);
    return result;
  }
  Scene scene;
  glm::dvec3 origin;
  VoxelFragments fragments;
  BinaryGrid bits;
  AttributeGrid attributes;
};

constexpr float kAlbedo = 0.5f;

/// A room whose walls lie at no voxel's face.
SceneBuilder room() {
  SceneBuilder builder;
  builder.box({-7.7f, -6.4f, -7.1f}, {7.4f, 7.8f, 6.6f}, builder.lambert(kAlbedo), true);
  return builder;
}

/// A floor at -0.6, and a wall on it at 2.8 that faces the floor's middle.
SceneBuilder floorAndWall() {
  SceneBuilder builder;
  const int white = builder.lambert(kAlbedo);
  builder.quad({-8, -0.6f, -8}, {0, 0, 16}, {16, 0, 0}, white);
  builder.quad({2.8f, -0.6f, -8}, {0, 0, 16}, {0, 6.0f, 0}, white);
  return builder;
}

}  // namespace

TEST_CASE("paths that end at planes bring the series of bounces of a closed room") {
  const Voxelized voxels(room(), 16);
  const glm::dvec3 place(0.2, 0.1, -0.3);
  for (const int bounces : {1, 2, 8}) {
    Gatherer paths = voxels.tracerAt(place, {0, 1, 0});
    paths.map(shiningAll(0.25f, kAlbedo, glm::vec3(place - voxels.origin)));
    paths
        .with({{"samples", 64},
               {"bounces", bounces},
               {"tolerance", 1000},
               {"front", "off"},
               {"normals", "voxels"}})
        .with(kPlanes);
    const double expected = 0.25 * (1.0 - std::pow(kAlbedo, bounces)) / (1.0 - kAlbedo);
    CAPTURE(bounces);
    // Of a thousand rays one or two leave through corners of three walls.
    CHECK(paths.mean("arriving") == Approx(expected).epsilon(0.005));
  }
}

TEST_CASE("a floor beside a wall gets the wall's light, of which boxes bring too much") {
  const Voxelized voxels(floorAndWall(), 16);
  const glm::dvec3 point(2.8 - 0.3, -0.6, 0.1);
  const double expected =
      polygonFormFactor(point, {0, 1, 0}, {{2.8, -0.6, -8}, {2.8, -0.6, 8}, {2.8, 5.4, 8}, {2.8, 5.4, -8}});
  const auto arriving = [&](const Settings& settings) {
    Gatherer paths = voxels.tracerAt(point, {0, 1, 0});
    paths.map(shiningAll(1.0f, kAlbedo, glm::vec3(point - voxels.origin)));
    return paths
        .with({{"samples", 1024}, {"bounces", 1}, {"tolerance", 1000}, {"front", "off"}, {"offset", 0.1}})
        .with(settings)
        .mean("arriving");
  };
  const double planes = arriving({{"stop", "plane"}}), boxes = arriving({{"offset", 1.0}});
  CAPTURE(expected, planes, boxes);
  CHECK(planes == Approx(expected).epsilon(0.05));
  CHECK(std::abs(boxes - expected) > 3.0 * std::abs(planes - expected));
}

TEST_CASE("in shadow a path goes on about the normal of the plane that it ended at") {
  // A slanted sheet under an even sky, in voxels that know no normals: it reflects the sky before it.
  SceneBuilder builder;
  builder.quad({-8, -3, -8}, {1, 2, 16}, {16, 4, -1}, builder.lambert(kAlbedo));
  builder.scene.environment = glm::vec3(1.0f);
  Voxelized voxels(builder, 32);
  voxels.attributes.normal = filled(volumeOf(voxels.bits.grid.resolution), glm::vec4(0.0f));
  // From far above its middle, looking along it, so that most paths end at a grazing angle.
  const glm::dvec3 along = glm::normalize(glm::dvec3(16, 4, -1)),
                   normal = glm::normalize(glm::cross(glm::dvec3(1, 2, 16), glm::dvec3(16, 4, -1)));
  const glm::dvec3 middle = glm::dvec3(-8, -3, -8) + 0.5 * glm::dvec3(17, 6, 15);
  const glm::dvec3 place = middle - 7.0 * along + 1.5 * normal;
  Gatherer paths = voxels.tracerAt(place, along);
  paths.with({{"samples", 1024}, {"bounces", 2}}).with(kPlanes);
  Gatherer first = voxels.tracerAt(place, along);
  first.with({{"samples", 1024}, {"bounces", 1}}).with(kPlanes);
  const double open = first.mean("arriving"), both = paths.mean("arriving");
  CAPTURE(open, both);
  REQUIRE(open < 0.8);
  CHECK(both == Approx(open + kAlbedo * (1.0 - open)).epsilon(0.005));
}

TEST_CASE("a ray that begins in a voxel with planes neither ends there nor is moved out of it") {
  SceneBuilder builder;
  builder.quad({-8, -0.6f, -8}, {0, 0, 16}, {16, 0, 0}, builder.lambert(kAlbedo));
  builder.scene.environment = glm::vec3(1.0f);
  const Voxelized voxels(builder, 16);
  const auto arriving = [&](const char* stuck, const char* stop) {
    return voxels.tracerAt({0, 2, 0}, {0, -1, 0})
        .with({{"samples", 64}, {"bounces", 2}, {"offset", 0.1}, {"stuck", stuck}, {"stop", stop}})
        .mean("arriving");
  };
  // The floor reflects half of the sky; where a ray ends in its own voxel it stays dark.
  CHECK(arriving("hit", "plane") == arriving("push", "plane"));
  CHECK(arriving("hit", "plane") > arriving("hit", "box") + 0.3);
}

TEST_CASE("a path stays between a floor and a ceiling that are less than a voxel apart") {
  SceneBuilder builder;
  const int white = builder.lambert(kAlbedo);
  builder.quad({-8, -0.6f, -8}, {0, 0, 16}, {16, 0, 0}, white);
  builder.quad({-8, 0.3f, -8}, {16, 0, 0}, {0, 0, 16}, white);
  builder.scene.environment = glm::vec3(1.0f);
  const Voxelized voxels(builder, 16);
  Gatherer paths = voxels.tracerAt({0, -0.1, 0}, {0, -1, 0});
  // Moved out of the floor's voxel, it would go on above the ceiling, under the sky.
  CHECK(paths.with({{"samples", 64}, {"bounces", 2}, {"offset", 0.1}, {"stop", "plane"}}).mean("arriving") <
        0.1);
}

TEST_CASE("paths end so near the surface that a map shows it with a fifth of the tolerance") {
  SceneBuilder builder = room();
  builder.light(LightKind::point, glm::vec3(1.0f), {0.3, 0.2, 0.1});
  const Voxelized voxels(builder, 16);
  const auto map =
      LonePass("reflective_shadow_maps.render", voxels.scene).out<ReflectiveShadowMap>("surfaces");
  const auto arriving = [&](const Settings& settings) {
    Gatherer paths = voxels.tracerAt({0, 1, 0}, {0, 1, 0});
    paths.map(map);
    return paths.with({{"samples", 64}, {"bounces", 1}}).with(settings).mean("arriving");
  };
  const double planes = arriving(kPlanes);
  REQUIRE(planes > 0.0);
  CHECK(arriving({{"stop", "plane"}, {"offset", 0.5}, {"tolerance", 0.2}}) == Approx(planes).epsilon(0.02));
  CHECK(arriving({{"tolerance", 0.1}}) < 0.5 * arriving({}));
}

TEST_CASE("paths that end at boxes ignore the fragments, to the bit") {
  const Voxelized voxels(floorAndWall(), 16);
  const auto arriving = [&](bool connected) {
    Gatherer paths =
        tracer(voxels.bits, glm::vec3(glm::dvec3(1, 3, 0) - voxels.origin), {0, -1, 0}, underSky(1.0f));
    if (connected) paths.in("fragments", voxels.fragments);
    paths.in("attributes", voxels.attributes);
    return paths.with({{"samples", 16}, {"bounces", 3}}).arriving();
  };
  CHECK(arriving(true) == arriving(false));
}

TEST_CASE("planes without fragments, with stored paths or with another walk are refused") {
  const Voxelized voxels(room(), 16);
  const auto refused = [&](const Settings& settings, bool connected, const Tells& tells) {
    Gatherer paths = tracer(voxels.bits, kUp, kUp);
    if (connected) paths.in("fragments", voxels.fragments);
    paths.in("attributes", voxels.attributes);
    paths.with(kPlanes).with(settings);
    CHECK_THROWS_MATCHES(paths.run(), Error, tells);
  };
  refused({}, false, Tells("voxel_path_tracing.trace", "stop plane", "fragments", "connected"));
  refused({{"order", "backward"}}, true, Tells("stop plane", "order backward", "stop box"));
  refused({{"method", "plain"}}, true, Tells("stop plane", "method plain", "stop box"));
  refused({{"method", "printed"}}, true, Tells("stop plane", "method printed", "stop box"));
}
