// Lights and cameras that move: what texts may say of them, and what they are at a time.
#include <cmath>
#include <numbers>

#include "lumivox/base/error.h"
#include "lumivox/scene/free_camera.h"
#include "support/facts.h"
#include "support/support.h"

using namespace lumivox;
using lumivox::test::Tells;

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
const char* const kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

/// A camera, a mesh and a light of each kind, in lines 2 to 9; what is given stands in line 10 and after.
std::string textOf(const std::string& inside) {
  return "scene \"x\" {\ncamera main { eye 0 0 4  target 0 0 0 }\nmesh room { file \"m.obj\" }\n"
         "mesh lamp { file \"m.obj\" }\n"
         "light sun directional { direction 0 -1 0  irradiance 4 }\n"
         "light bulb point { position 0 2 0  intensity 3 }\n"
         "light cone spot { position 0 2 0  direction 0 -1 0  intensity 3  inner 10 deg  outer 20 deg }\n"
         "light lamp area { mesh lamp  radiance 2 }\n"
         "camera path {\nkey { time 0  eye 0 0 4  target 0 0 0 }  key { time 2 s  eye 2 0 4  target 2 0 0 } }\n" +
         inside + "\n}\n";
}

Scene sceneWith(const std::string& inside) {
  const test::TemporaryDirectory directory;
  directory.write("m.obj", kTriangle);
  return loadScene(directory.write("a.scene", textOf(inside)));
}

std::string findingsOf(const std::string& inside) {
  const test::TemporaryDirectory directory;
  directory.write("m.obj", kTriangle);
  const auto file = directory.write("a.scene", textOf(inside));
  return test::messageOf<DiagnosticsError>([&] { checkScene(file); });
}

/// The lights in world space: relative to no origin.
LightState lightAt(const Scene& scene, std::size_t light, double time) {
  const SceneSnapshot snapshot = snapshotOf(scene, time);
  LightState state = snapshot.lights.at(light);
  state.position += glm::vec3(snapshot.origin);
  return state;
}

constexpr std::size_t kSun = 0, kBulb = 1, kCone = 2;

void checkNear(const glm::vec3& a, const glm::vec3& b) {
  CAPTURE(a.x, a.y, a.z, b.x, b.y, b.z);
  CHECK(glm::distance(a, b) < 1e-5f);
}

}  // namespace

TEST_CASE("a lamp with a step key is on with its own intensity until the key, and off from then on") {
  const Scene scene = sceneWith("animate bulb { interpolation step\nkey { time 2 s  intensity 0 } }");
  CHECK(lightAt(scene, kBulb, -1.0).power == glm::vec3(3));
  CHECK(lightAt(scene, kBulb, 1.999).power == glm::vec3(3));
  CHECK(lightAt(scene, kBulb, 2.0).power == glm::vec3(0));
  CHECK(lightAt(scene, kBulb, 9.0).power == glm::vec3(0));
  const SceneTraits traits = SceneTraits::of(scene);
  CHECK((traits.movingLights && traits.pointLights == 1 && !traits.movingGeometry));
}

TEST_CASE(
    "a light that is dark in its block and lit by keys counts as a light, and one without keys does not") {
  const char* dark = "light night point { position 0 1 0  intensity 0 }\n";
  CHECK(SceneTraits::of(sceneWith(dark)).pointLights == 1);  // the bulb
  const std::string keys = "animate night { key { time 0  intensity 0 }  key { time 1 s  intensity 2 } }";
  CHECK(SceneTraits::of(sceneWith(dark + keys)).pointLights == 2);
  CHECK_FALSE(SceneTraits::of(sceneWith(dark)).movingLights);
}

TEST_CASE("values of a light are linear between the keys that set them, and rest outside") {
  const Scene scene = sceneWith(
      "animate cone {\n"
      "key { time 1 s  position 0 2 0  intensity 1 2 3  outer 30 deg }\n"
      "key { time 2 s  inner 10 deg }\n"
      "key { time 3 s  position 4 2 0  inner 20 deg }\n"
      "key { time 5 s  intensity 5 2 3  outer 50 deg } }");
  for (const auto& [time, x, red, inner, outer] : {std::tuple{0.0, 0.0, 1.0, 10.0, 30.0},
                                                   {1.5, 1.0, 1.5, 10.0, 32.5},
                                                   {2.5, 3.0, 2.5, 15.0, 37.5},
                                                   {4.0, 4.0, 4.0, 20.0, 45.0},
                                                   {9.0, 4.0, 5.0, 20.0, 50.0}}) {
    CAPTURE(time);
    const LightState state = lightAt(scene, kCone, time);
    checkNear(state.position, {x, 2, 0});
    checkNear(state.power, {red, 2, 3});
    CHECK(state.innerAngle == Approx(inner * kDegree));
    CHECK(state.outerAngle == Approx(outer * kDegree));
    checkNear(state.direction, {0, -1, 0});  // no key sets it
  }
}

TEST_CASE("a direction between keys is the mean of theirs, scaled to unit length") {
  const Scene scene =
      sceneWith("animate sun { key { time 0  direction 2 0 0 }  key { time 4 s  direction 0 -1 0 } }");
  const double half = std::sqrt(0.5);
  checkNear(lightAt(scene, kSun, 2.0).direction, {half, -half, 0});
  const double length = std::sqrt(0.75 * 0.75 + 0.25 * 0.25);
  checkNear(lightAt(scene, kSun, 1.0).direction, {0.75 / length, -0.25 / length, 0});
}

TEST_CASE("rates turn the sun's direction, carry a lamp, and turn a spot about a point") {
  const Scene scene = sceneWith(
      "animate sun { rotate 0 0 1  15 deg/s }\n"
      "animate bulb { translate 1 0 -2 }\n"
      "animate cone { rotate 0 1 0  90 deg/s  about 1 0 0  translate 0 0 1 }");
  const double angle = 30 * kDegree;
  checkNear(lightAt(scene, kSun, 2.0).direction, {std::sin(angle), -std::cos(angle), 0});
  checkNear(lightAt(scene, kBulb, 3.0).position, {3, 2, -6});
  // (-1, 2, 0) from the point turns to (0, 2, 1) in a second.
  checkNear(lightAt(scene, kCone, 1.0).position, {1, 2, 2});
  checkNear(lightAt(scene, kCone, 1.0).direction, {0, -1, 0});
  CHECK(lightAt(scene, kSun, 2.0).power == glm::vec3(4));
}

TEST_CASE("a spot turns about its own position unless a point is given, and keys come before the turn") {
  const Scene scene = sceneWith(
      "animate cone {\nrotate 1 0 0  90 deg/s\n"
      "key { time 0  position 0 2 0 }  key { time 1 s  position 0 3 0 } }");
  checkNear(lightAt(scene, kCone, 0.0).position, {0, 2, 0});
  // One metre above the point about which it turns, by a quarter turn about x: in front of it.
  checkNear(lightAt(scene, kCone, 1.0).position, {0, 2, 1});
  checkNear(lightAt(scene, kCone, 1.0).direction, {0, 0, -1});
}

TEST_CASE("a camera's keys may stand in `animate`, with steps and with its angle of view") {
  const Scene scene = sceneWith(
      "animate main {\ninterpolation step\nkey { time 1 s  eye 1 0 4 }\nkey { time 2 s  target 1 0 0  fov 60 deg } }");
  CHECK(SceneTraits::of(scene).movingCamera);
  const Camera& camera = scene.camera("main");
  const auto at = [&](double time) { return cameraAt(camera, time); };
  CHECK(at(0.5).eye == glm::dvec3(0, 0, 4));
  CHECK(at(1.5).eye == glm::dvec3(1, 0, 4));
  CHECK(at(1.5).target == glm::dvec3(0));
  CHECK(at(2.0).target == glm::dvec3(1, 0, 0));
  CHECK(at(1.5).fov == Approx(40 * kDegree));
  CHECK(at(2.0).fov == Approx(60 * kDegree));
  CHECK(snapshotOf(scene, 2.0, "main").camera.tanHalfFov == Approx(std::tan(30 * kDegree)));
}

TEST_CASE("a value that a camera's key passes over goes on between the keys around it") {
  const Scene scene = sceneWith(
      "animate main { key { time 0  eye 0 0 4  fov 20 deg }  key { time 1 s  target 0 1 0 }\n"
      "key { time 2 s  eye 4 0 4  target 0 3 0  fov 60 deg } }");
  const Camera middle = cameraAt(scene.camera("main"), 1.0), later = cameraAt(scene.camera("main"), 1.5);
  CHECK(middle.eye == glm::dvec3(2, 0, 4));
  CHECK(middle.fov == Approx(40 * kDegree));
  CHECK(later.target == glm::dvec3(0, 2, 0));
  CHECK(later.eye == glm::dvec3(3, 0, 4));
}

TEST_CASE("a camera turns about its eye, or about a point, with its up") {
  const Scene scene = sceneWith(
      "animate main { rotate 0 0 1  90 deg/s }\nanimate path { rotate 0 1 0  90 deg/s  about 0 0 0 }");
  const Camera rolled = cameraAt(scene.camera("main"), 1.0), orbited = cameraAt(scene.camera("path"), 1.0);
  checkNear(rolled.eye, {0, 0, 4});
  checkNear(rolled.up, {-1, 0, 0});
  checkNear(orbited.eye, {4, 0, -1});  // (1, 0, 4) by its keys, turned
  checkNear(orbited.target, {0, 0, -1});
  CHECK(SceneTraits::of(scene).movingCamera);
}

TEST_CASE("an area light moves with its mesh although both have one name") {
  const Scene scene = sceneWith("animate lamp { translate 1 0 0 }");
  CHECK(scene.objects.at(1).motion.has_value());
  CHECK(SceneTraits::of(scene).movingGeometry);
  CHECK_FALSE(SceneTraits::of(scene).movingLights);
}

TEST_CASE("each mistake in an animation is told with its place, its names and what is expected") {
  const auto [inside, told] = GENERATE(table<const char*, Tells>({
      {"animate son { rotate 0 0 1 15 deg/s }", Tells("mesh", "light", "camera", "son", "sun")},
      {"animate mian { translate 1 0 0 }", Tells("mian", "main")},
      {"camera room { eye 0 0 1  target 0 0 0 }\nanimate room { translate 1 0 0 }",
       Tells("a.scene:12:9", "room", "mesh", "camera", "name")},
      {"light main point { position 0 0 0  intensity 1 }\nanimate main { translate 1 0 0 }",
       Tells("main", "light", "camera", "name")},
      {"light shine area { mesh room  radiance 1 }\nanimate shine { key { time 0  intensity 1 } }",
       Tells("shine", "area", "mesh", "radiance", "animate")},
      {"animate room { key { time 0  intensity 1 } }", Tells("key", "mesh", "room", "rotate", "translate")},
      {"animate room { interpolation step  translate 1 0 0 }", Tells("interpolation", "without", "keys")},
      {"animate room { about 1 0 0 }", Tells("about", "rotate")},
      {"animate bulb { }", Tells("a.scene:11:1", "nothing", "key", "rotate", "translate")},
      {"animate bulb { interpolation linear  translate 1 0 0 }", Tells("interpolation", "without", "keys")},
      {"animate bulb { interpolation smooth\nkey { time 0  intensity 1 } }",
       Tells("interpolation", "linear", "step")},
      {"animate bulb {\nkey { time 0 } key { time 1 s  intensity 1 } }",
       Tells("a.scene:12:1", "sets", "nothing", "position", "intensity")},
      {"animate bulb { key { intensity 1 } }", Tells("time")},
      {"animate bulb { interpolation step\nkey { time 0  direction 0 1 0 } }",
       Tells("a.scene:12:", "direction", "point", "position", "intensity")},
      {"animate sun { interpolation step\nkey { time 0  position 0 1 0 } }",
       Tells("position", "directional", "direction", "irradiance")},
      {"animate sun { interpolation step\nkey { time 0  intensity 1 } }",
       Tells("intensity", "directional", "irradiance")},
      {"animate cone { interpolation step\nkey { time 0  eye 0 1 0 } }", Tells("eye", "spot", "outer")},
      {"animate main { interpolation step\nkey { time 0  position 0 1 0 } }",
       Tells("position", "camera", "eye", "target", "fov")},
      {"animate bulb { key { time 0  intensity -1 }  key { time 1 s  intensity 1 } }",
       Tells("intensity", "range")},
      {"animate bulb { key { time 0  radiance 1 } }", Tells("radiance")},
      {"animate bulb { key { time 2 s  intensity 1 }\nkey { time 1 s  intensity 0 } }",
       Tells("a.scene:12:7", "backwards", "after", "2")},
      {"animate bulb { key { time 2 s  intensity 1 }  key { time 2000 ms  intensity 0 } }",
       Tells("backwards", "after", "2")},
      {"animate bulb { key { time 2 s  intensity 0 } }", Tells("intensity", "one", "key", "step")},
      {"animate sun { key { time 0  direction 0 -1 0 }\nkey { time 1 s  direction 0 1 0 } }",
       Tells("a.scene:12:17", "opposite", "between", "rotate", "step")},
      {"animate sun { interpolation step\nkey { time 0  direction 0 0 0 } }", Tells("direction", "zero")},
      {"animate cone { interpolation step\nkey { time 0  inner 20 deg } }", Tells("inner", "outer")},
      // Between keys: at 1 s the outer angle has come down to 15 deg.
      {"animate cone { key { time 0  outer 20 deg  inner 5 deg }\nkey { time 1 s  inner 16 deg }\n"
       "key { time 2 s  outer 10 deg  inner 5 deg } }",
       Tells("a.scene:12:1", 1, "inner", "outer")},
      {"animate sun { translate 1 0 0 }", Tells("translate", "directional", "rotate")},
      {"animate sun { rotate 0 0 1 15 deg/s  about 1 0 0 }", Tells("about", "directional")},
      {"animate bulb { rotate 0 0 1 15 deg/s }", Tells("rotate", "point", "about")},
      {"animate bulb { translate 1 0 0 }\nanimate bulb { translate 1 0 0 }",
       Tells("a.scene:12:9", "bulb", "twice")},
      {"animate main { translate 1 0 0 }\nanimate main { translate 1 0 0 }", Tells("main", "twice")},
      {"animate path { key { time 0  eye 0 0 3 }  key { time 1 s  eye 0 0 2 } }",
       Tells("path", "keys", "one", "of", "two")},
      {"animate main { key { time 0  eye 0 0 4 }  key { time 1 s  eye 0 0 0 } }",
       Tells("eye", "target", "same")},
      {"camera b { eye 0 0 1  target 0 0 0  interpolation step }", Tells("interpolation", "without", "keys")},
      {"camera b { eye 0 0 1  key { time 0  eye 0 0 1 } }", Tells("camera b", "lacks", "target")},
      {"animate bulb { rotate 0 0 0 15 deg/s  about 1 0 0 }", Tells("rotate", "zero")},
  }));
  CAPTURE(inside);
  CHECK_THAT(findingsOf(inside), told && Catch::Contains("a.scene:"));
}

TEST_CASE("a camera that stands where a capture's stood is not animated") {
  CHECK_THAT(findingsOf("capture desk { folder \"none\"  focal 500 500  centre 320 240 }\n"
                        "camera seen { capture desk }\nanimate seen { translate 1 0 0 }"),
             Tells("a.scene:13:1", "seen", "capture"));
}

TEST_CASE("an animation of a light whose block is refused has no finding of its own") {
  const std::string told = findingsOf("light weak point { intensity 1 }\nanimate weak { translate 1 0 0 }");
  CHECK_THAT(told, Tells("weak", "lacks", "position"));
  CHECK_THAT(told, !Catch::Contains("animate"));
}

TEST_CASE("keys made by code that turn between opposite directions are refused at the time between them") {
  Scene scene = sceneWith("animate sun { rotate 0 0 1  15 deg/s }");
  LightMotion motion;
  motion.keys.resize(2);
  motion.keys[0].direction = glm::dvec3(0, -1, 0);
  motion.keys[1].time = 2.0;
  motion.keys[1].direction = glm::dvec3(0, 1, 0);
  scene.lights[kSun].motion = motion;
  CHECK_NOTHROW(snapshotOf(scene, 0.5));
  CHECK_THROWS_MATCHES(snapshotOf(scene, 1.0), Error, Tells("sun", "opposite", 1));
}
