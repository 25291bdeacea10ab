// The scenes that the stress battery is made of: a case that measures a difference is worth no more than the
// claim that there is none in the reference.
#include <cmath>

#include "lumivox/base/error.h"
#include "lumivox/toolkit/grid_placement.h"
#include "stress/scene_pieces.h"
#include "support/facts.h"
#include "support/scene_builder.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

/// A lit room of 1 m with a light, a spot, something glossy and fog: all that moved() must move.
Scene furnishedRoom() {
  SceneBuilder builder = stress::closedRoom(0.6f);
  builder.quad({0.4f, 0.99f, 0.4f}, {0.2f, 0, 0}, {0, 0, 0.2f}, builder.lambert(0.5f, 4.0f));
  builder.box({0.2f, 0.01f, 0.3f}, {0.4f, 0.3f, 0.5f}, builder.phong(0.3f, 0.4f, 20.0f), false);
  Light& spot = builder.light(LightKind::spot, glm::vec3(0.7f), {0.8, 0.9, 0.7}, {-0.5, -0.7, -0.4});
  spot.innerAngle = 0.3f;
  spot.outerAngle = 0.6f;
  Medium fog;
  fog.extinction = glm::vec3(0.6f);
  fog.albedo = glm::vec3(0.7f);
  fog.anisotropy = 0.4f;
  fog.box = {{0.1, 0.1, 0.1}, {0.7, 0.6, 0.8}};
  builder.scene.media.push_back(fog);
  return builder.scene;
}

Estimate referenceOf(const Scene& scene, int samples, const std::string& camera = {}) {
  ReferenceOptions options = quietly(samples, 4);
  options.width = options.height = 24;
  options.camera = camera;
  return estimateOf(renderReference(scene, options), "full");
}

double meanOfReference(const Scene& scene, const std::string& camera = {}) {
  return referenceOf(scene, 32, camera).mean;
}

}  // namespace

TEST_CASE("a scene that is scaled, turned and moved with everything in it has the same reference") {
  const Scene scene = furnishedRoom();
  const auto movedBy = [&](double scale, double turn) {
    stress::Similarity by;
    by.scale = scale;
    by.rotation = stress::turnAboutY(turn);
    by.translation = {1e4, -20.0, 1e4};
    return stress::moved(scene, by);
  };
  CHECK(meanOfReference(movedBy(1.0, 0.0)) == Approx(meanOfReference(scene)).epsilon(0.001));
  // The same random numbers: only rounding differs.
  for (const double turn : {0.0, 0.5 * kPi}) {
    const double wanted = meanOfReference(movedBy(1.0, turn));
    CHECK(wanted > 0.1);
    for (const double scale : {1e-3, 1e3}) {
      INFO("scale " << scale << ", turned by " << turn);
      CHECK(meanOfReference(movedBy(scale, turn)) == Approx(wanted).epsilon(0.001));
    }
  }
  // Directions are drawn about axes of the world, so that a turn draws others: the means differ by their
  // noise, which is small enough here to tell a hundredth.
  const Estimate still = referenceOf(scene, 1024), turned = referenceOf(movedBy(1.0, 0.5 * kPi), 1024);
  const double noise = std::hypot(still.deviation, turned.deviation);
  CHECK(noise < 0.01 * still.mean);
  CHECK(std::abs(turned.mean - still.mean) < 3.0 * noise);
}

TEST_CASE("lights and cameras that move do so in a scene that is scaled, turned and moved, and brighter") {
  Scene scene = furnishedRoom();
  LightMotion& motion = scene.lights[0].motion.emplace();
  motion.rigid =
      RigidMotion{.axis = {1, 0, 0}, .angularSpeed = 0.3, .pivot = {0, 1, 0}, .velocity = {0, 0, 1}};
  motion.keys.resize(2);
  motion.keys[0].position = glm::dvec3(0.8, 0.9, 0.7);
  motion.keys[0].direction = glm::dvec3(0, -1, 0);
  motion.keys[0].power = glm::vec3(0.5f);
  motion.keys[1] = {2.0, glm::dvec3(0.2, 0.5, 0.7), glm::dvec3(1, 0, 0), glm::vec3(1.5f), {}, {}};
  scene.cameras[0].motion = RigidMotion{.angularSpeed = 0.2, .pivot = {0.5, 0, 0.5}};
  stress::Similarity by;
  by.scale = 10.0;
  by.rotation = stress::turnAboutY(0.5 * kPi);
  by.translation = {3.0, -20.0, 5.0};
  const SceneSnapshot before = snapshotOf(scene, 1.5), after = snapshotOf(stress::moved(scene, by), 1.5),
                      bright = snapshotOf(stress::brighter(scene, 4.0f), 1.5);
  const auto place = [&](const SceneSnapshot& snapshot, const glm::vec3& p) {
    return snapshot.origin + glm::dvec3(p);
  };
  const auto checkSame = [](const glm::dvec3& a, const glm::dvec3& b) { CHECK(glm::distance(a, b) < 1e-4); };
  const auto expected = [&](const glm::vec3& p) {
    return by.scale * (by.rotation * place(before, p)) + by.translation;
  };
  const LightState &one = before.lights[0], &other = after.lights[0];
  checkSame(place(after, other.position), expected(one.position));
  checkSame(other.direction, by.rotation * glm::dvec3(one.direction));
  checkSame(other.power, 100.0f * one.power);
  checkSame(place(after, after.camera.eye), expected(before.camera.eye));
  checkSame(after.camera.forward, by.rotation * glm::dvec3(before.camera.forward));
  checkSame(bright.lights[0].power, 4.0f * one.power);
}

TEST_CASE("what cannot be turned without changing what it is is refused") {
  stress::Similarity by;
  by.rotation = stress::turnAboutY(0.3);
  CHECK_THROWS_MATCHES(stress::moved(furnishedRoom(), by), Error, Tells("quarter turns"));
}

TEST_CASE("all light times a factor is the reference times the factor") {
  const Scene scene = furnishedRoom();
  CHECK(meanOfReference(stress::brighter(scene, 64.0f)) ==
        Approx(64.0 * meanOfReference(scene)).epsilon(1e-4));
  CHECK(meanOfReference(stress::brighter(scene, 0.0f)) == 0.0);
}

TEST_CASE("the reference of the dark one of two rooms is black, whatever the wall between them") {
  for (const float wall : {0.0f, 0.01f}) {
    INFO("wall of " << wall << " m");
    const Scene scene = stress::twoRooms(wall);
    CHECK(meanOfReference(scene, "lit") > 0.1);
    CHECK(meanOfReference(scene, "dark") == 0.0);
  }
}

TEST_CASE("a room in bounds leaves the scene's grid where it is, and its reference as it is") {
  const auto gridOf = [](const Scene& scene) { return placeGrid(snapshotOf(scene, 0.0).gridBounds, 16); };
  const Scene middle = stress::roomInBounds({glm::dvec3(-0.4), 0.8}),
              aside = stress::roomInBounds({glm::dvec3(-0.32, -0.45, -0.37), 0.8});
  CHECK(gridOf(middle) == gridOf(aside));
  CHECK(gridOf(middle).low.x == Approx(-0.75f).margin(2.0 * gridOf(middle).voxelSize));
  CHECK(snapshotOf(aside, 0.0).origin == glm::dvec3(0.0));
  CHECK(meanOfReference(middle) == Approx(meanOfReference(stress::closedRoom(0.7f).scene)).epsilon(0.001));
  CHECK(meanOfReference(aside) == Approx(meanOfReference(middle)).epsilon(0.001));
}

TEST_CASE("the tunnel has 1024 voxels from end to end in a grid of as many, and light all along it") {
  const Scene scene = stress::tunnel();
  const GridPlacement grid = placeGrid(snapshotOf(scene, 0.0).gridBounds, 1024);
  CHECK(grid.resolution.z == 1024);
  CHECK(grid.resolution.x < 80);
  CHECK(meanOfReference(scene) > 0.1);
}

TEST_CASE("a grid of triangles has the area of its parallelogram and faces one way") {
  const std::vector<glm::vec3> corners = stress::gridOfTriangles({1, 2, 3}, {2, 0, 0}, {0, 0, -3}, 7, 5);
  REQUIRE(corners.size() == 3 * 2 * 7 * 5);
  double area = 0.0;
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    const glm::dvec3 cross =
        glm::cross(glm::dvec3(corners[i + 1] - corners[i]), glm::dvec3(corners[i + 2] - corners[i]));
    CHECK(cross.y > 0.0);
    area += 0.5 * cross.y;
  }
  CHECK(area == Approx(6.0).epsilon(1e-6));
}

TEST_CASE("doubled surfaces are all but those that shine, and the reference stays") {
  const Scene scene = furnishedRoom(), twice = stress::doubled(scene);
  CHECK(twice.objects.size() == 2 * scene.objects.size() - 1);
  CHECK(meanOfReference(twice) == Approx(meanOfReference(scene)).epsilon(0.02));
}

TEST_CASE("the glowing speck lies within one voxel of the grids that it was made for") {
  const Scene scene = stress::glowingSpeck(188);
  const Object& speck = scene.objects.back();
  CHECK(speck.vertexCount / 3 > 65536);
  const SceneSnapshot snapshot = snapshotOf(scene, 0.0);
  for (const int resolution : {16, 32, 64}) {
    INFO(resolution);
    const GridPlacement grid = placeGrid(snapshot.gridBounds, resolution);
    const auto voxelOf = [&](std::uint32_t vertex) {
      return glm::ivec3(
          glm::floor((scene.positions[vertex] - glm::vec3(snapshot.origin) - grid.low) / grid.voxelSize));
    };
    const glm::ivec3 first = voxelOf(speck.firstVertex);
    std::size_t elsewhere = 0;
    for (std::uint32_t v = 0; v < speck.vertexCount; ++v)
      elsewhere += voxelOf(speck.firstVertex + v) != first;
    CHECK(elsewhere == 0);
  }
}
