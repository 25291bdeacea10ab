// The reference at moments of lights and cameras that move, against closed forms, and what names its images.
#include <cmath>
#include <set>

#include "lumivox/reference/path_tracer.h"
#include "support/scene_builder.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

constexpr float kAlbedo = 0.6f;

SceneBuilder floorOnly() {
  SceneBuilder builder;
  builder.quad({-50, 0, -50}, {0, 0, 100}, {100, 0, 0}, builder.lambert(kAlbedo));
  builder.look({0, 3, 0}, {0, 0, 0}, {0, 0, -1}, 0.5, 4, 4);
  return builder;
}

/// Radiance of the floor at (x, 0, z), seen steeply from above.
double floorRadiance(const Scene& scene, double time, double x, double z) {
  return referenceRadiance(scene, time, {x + 0.02, 0.1, z - 0.01}, {-0.02f, -0.1f, 0.01f}, quietly(1, 0)).y;
}

/// What names the kept image of a scene without a text.
std::string hashOf(const Scene& scene) {
  return renderReference(scene, quietly(2, 0)).attributes.at("hash");
}

LightKey keyAt(double time) {
  LightKey key;
  key.time = time;
  return key;
}

}  // namespace

TEST_CASE(
    "a point light that moves along a line gives a I cos / (pi d^2) at each time, by keys and by rates") {
  const bool byKeys = GENERATE(true, false);
  CAPTURE(byKeys);
  SceneBuilder builder = floorOnly();
  LightMotion& motion = builder.light(LightKind::point, glm::vec3(7.0f), {-1, 2, 0}).motion.emplace();
  if (byKeys) {
    motion.keys = {keyAt(0.0), keyAt(4.0)};
    motion.keys[0].position = glm::dvec3(-1, 2, 0);
    motion.keys[1].position = glm::dvec3(3, 2, 2);
  } else {
    motion.rigid = RigidMotion{.velocity = {1.0, 0.0, 0.5}};
  }
  for (const double time : {0.0, 0.5, 2.0, 4.0}) {
    CAPTURE(time);
    const double x = -1.0 + time, z = 0.5 * time, squaredDistance = x * x + 4.0 + z * z;
    const double cosine = 2.0 / std::sqrt(squaredDistance);
    CHECK(floorRadiance(builder.scene, time, 0.0, 0.0) ==
          Approx(kAlbedo * 7.0 * cosine / (kPi * squaredDistance)).epsilon(0.001));
  }
}

TEST_CASE("a sun that turns gives a E cos / pi of its angle at each time, and nothing from below the floor") {
  SceneBuilder builder = floorOnly();
  builder.light(LightKind::directional, glm::vec3(3.0f), {}, {0, -1, 0}).motion.emplace().rigid =
      RigidMotion{.axis = {0, 0, 1}, .angularSpeed = 0.25};
  for (const double time : {0.0, 1.0, 3.0, 6.0, 7.0}) {
    CAPTURE(time);
    CHECK(floorRadiance(builder.scene, time, 1.0, 2.0) ==
          Approx(kAlbedo * 3.0 * std::max(std::cos(0.25 * time), 0.0) / kPi).epsilon(0.001).margin(1e-12));
  }
}

TEST_CASE("a lamp that a step key switches off lights the floor until the key and not a moment longer") {
  SceneBuilder builder = floorOnly();
  LightMotion& motion = builder.light(LightKind::point, glm::vec3(7.0f), {0, 2, 0}).motion.emplace();
  motion.interpolation = Interpolation::step;
  motion.keys = {keyAt(1.0)};
  motion.keys[0].power = glm::vec3(0.0f);
  CHECK(floorRadiance(builder.scene, 0.999, 0.0, 0.0) == Approx(kAlbedo * 7.0 / (kPi * 4.0)).epsilon(0.001));
  CHECK(floorRadiance(builder.scene, 1.0, 0.0, 0.0) == 0.0);
}

TEST_CASE("a light that is dark at rest and lit by its keys is sampled when it is lit") {
  SceneBuilder builder = floorOnly();
  LightMotion& motion = builder.light(LightKind::point, glm::vec3(0.0f), {0, 2, 0}).motion.emplace();
  motion.keys = {keyAt(0.0), keyAt(2.0)};
  motion.keys[0].power = glm::vec3(0.0f);
  motion.keys[1].power = glm::vec3(8.0f);
  CHECK(floorRadiance(builder.scene, 0.0, 0.0, 0.0) == 0.0);
  CHECK(floorRadiance(builder.scene, 1.0, 0.0, 0.0) == Approx(kAlbedo * 4.0 / (kPi * 4.0)).epsilon(0.001));
}

TEST_CASE("whatever says how a light or a camera moves names the reference's image") {
  using Change = void (*)(Scene&);
  SceneBuilder builder = floorOnly();
  LightMotion& motion = builder.light(LightKind::spot, glm::vec3(7.0f), {0, 2, 0}).motion.emplace();
  motion.keys = {keyAt(0.0), keyAt(1.0)};
  builder.scene.cameras.front().keys = {{0.0, {0, 3, 0}, {0, 0, 0}}, {1.0, {0, 2, 0}, {0, 0, 0}}};
  static const auto keys = [](Scene& scene) -> std::vector<LightKey>& {
    return scene.lights.front().motion->keys;
  };
  const std::vector<Change> changes{
      [](Scene& scene) { scene.lights.front().motion.reset(); },
      [](Scene& scene) { scene.lights.front().motion->interpolation = Interpolation::step; },
      [](Scene& scene) { scene.lights.front().motion->rigid = RigidMotion{}; },
      [](Scene& scene) { scene.lights.front().motion->rigid = RigidMotion{.angularSpeed = 1.0}; },
      [](Scene& scene) {
        scene.lights.front().motion->rigid = RigidMotion{.velocity = {1, 0, 0}};
      },
      [](Scene& scene) { keys(scene).pop_back(); },
      [](Scene& scene) { keys(scene)[1].time = 2.0; },
      [](Scene& scene) { keys(scene)[1].position = glm::dvec3(0.0); },
      [](Scene& scene) { keys(scene)[1].direction = glm::dvec3(0, -1, 0); },
      [](Scene& scene) { keys(scene)[1].power = glm::vec3(0.0f); },
      [](Scene& scene) { keys(scene)[0].power = glm::vec3(0.0f); },
      [](Scene& scene) { keys(scene)[1].innerAngle = 0.0f; },
      [](Scene& scene) { keys(scene)[1].outerAngle = 0.0f; },
      [](Scene& scene) { scene.cameras.front().interpolation = Interpolation::step; },
      [](Scene& scene) { scene.cameras.front().motion = RigidMotion{}; },
      [](Scene& scene) {
        scene.cameras.front().motion = RigidMotion{.pivot = {1, 0, 0}};
      },
      [](Scene& scene) { scene.cameras.front().keys[1].fov = 0.4; },
      [](Scene& scene) { scene.cameras.front().keys[0].fov = 0.4; },
  };
  std::set<std::string> hashes{hashOf(builder.scene)};
  for (const Change change : changes) {
    Scene scene = builder.scene;
    change(scene);
    hashes.insert(hashOf(scene));
  }
  CHECK(hashes.size() == changes.size() + 1);
}
