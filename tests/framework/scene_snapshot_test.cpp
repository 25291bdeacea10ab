// A scene at one time: cameras, motion, deformation, precision.
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "lumivox/base/error.h"
#include "lumivox/base/random.h"
#include "lumivox/scene/scene.h"
#include "support/facts.h"
#include "support/support.h"

using namespace lumivox;
using lumivox::test::Tells;

namespace {

void checkNear(const glm::vec3& a, const glm::vec3& b, float tolerance = 1e-6f) {
  INFO(a.x << ' ' << a.y << ' ' << a.z << " against " << b.x << ' ' << b.y << ' ' << b.z);
  CHECK(glm::length(a - b) <= tolerance);
}

/// One triangle named "t" and a camera four metres in front of it.
Scene triangle() {
  Scene scene;
  scene.name = "test";
  scene.positions = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}};
  scene.normals.assign(3, {0, 0, 1});
  scene.texcoords.assign(3, {0, 0});
  scene.indices = {0, 1, 2};
  scene.materials.push_back({});
  Object object;
  object.name = "t";
  object.vertexCount = 3;
  object.parts = {{0, 0, 3}};
  scene.objects.push_back(object);
  Camera camera;
  camera.name = "main";
  camera.eye = {1, 1, 4};
  camera.target = {1, 1, 0};
  camera.fov = std::numbers::pi / 2;
  camera.width = 200;
  camera.height = 100;
  scene.cameras.push_back(camera);
  return scene;
}

/// The triangle's heights over time.
VertexSequence heights(const Scene& scene, double framesPerSecond, const std::vector<float>& frames) {
  VertexSequence sequence;
  sequence.framesPerSecond = framesPerSecond;
  for (const float height : frames) {
    std::vector<glm::vec3> positions = scene.positions;
    for (glm::vec3& position : positions) position.z += height;
    sequence.positions.push_back(positions);
    sequence.normals.push_back(scene.normals);
  }
  return sequence;
}

/// Bounds in the world.
void checkBounds(const Bounds& bounds, const glm::dvec3& origin, const glm::vec3& low,
                 const glm::vec3& high) {
  checkNear(bounds.low + glm::vec3(origin), low, 1e-5f);
  checkNear(bounds.high + glm::vec3(origin), high, 1e-5f);
}

}  // namespace

TEST_CASE("directions of the image's corners follow the vertical angle and square pixels") {
  const SceneSnapshot snapshot = snapshotOf(triangle(), 0.0);
  const CameraView& view = snapshot.camera;
  // tan(90 deg / 2) = 1 up and down, twice that to the sides of an image of 200 x 100.
  checkNear(view.direction(100, 50), {0, 0, -1});
  checkNear(view.direction(0, 0), {-2, 1, -1});
  checkNear(view.direction(200, 100), {2, -1, -1});
  const CameraView other = snapshotOf(triangle(), 0.0, {}, 64, 32).camera;  // in place of the camera's own
  CHECK((other.width == 64 && other.height == 32));
}

TEST_CASE("ambient occlusion looks as far as a tenth of the diagonal of what there is") {
  Bounds bounds;
  CHECK(ambientOcclusionDistance(bounds) == 0.0);
  bounds.grow({1, 1, 1});
  bounds.grow({2, 3, 3});  // 1 x 2 x 2: a diagonal of 3
  CHECK(ambientOcclusionDistance(bounds) == Approx(0.3));
}

TEST_CASE("the origin is the centre of static geometry, and positions are relative to it") {
  Scene scene = triangle();
  const SceneSnapshot snapshot = snapshotOf(scene, 0.0);
  CHECK(snapshot.origin == glm::dvec3(1, 1, 0));
  checkNear(snapshot.camera.eye, {0, 0, 4});
  checkBounds(snapshot.bounds, snapshot.origin, {0, 0, 0}, {2, 2, 0});
}

TEST_CASE("a scene ten thousand kilometres away has the same snapshot as at the origin, bit for bit") {
  Scene near = triangle(), far = triangle();
  const glm::dvec3 shift(1e7, 0, -1e7);
  far.objects[0].placement = glm::translate(glm::dmat4(1.0), shift);
  far.cameras[0].eye += shift;
  far.cameras[0].target += shift;
  const SceneSnapshot a = snapshotOf(near, 0.0), b = snapshotOf(far, 0.0);
  CHECK(a.objects[0].toWorld == b.objects[0].toWorld);
  CHECK(a.camera == b.camera);
  CHECK(a.bounds.low == b.bounds.low);
  CHECK(a.bounds.high == b.bounds.high);
}

TEST_CASE("rigid motion turns about its pivot and moves along its velocity") {
  Scene scene = triangle();
  // A quarter turn about Z through (1, 1): (2, 0) goes to (2, 2); then 3 s at 2 m/s along X.
  scene.objects[0].motion = RigidMotion{{0, 0, 1}, std::numbers::pi / 6, {1, 1, 0}, {2, 0, 0}};
  const SceneSnapshot snapshot = snapshotOf(scene, 3.0);
  const glm::vec3 moved(snapshot.objects[0].toWorld * glm::vec4(2, 0, 0, 1));
  checkNear(moved + glm::vec3(snapshot.origin), {8, 2, 0}, 1e-5f);
  checkNear(snapshot.objects[0].normalToWorld * glm::vec3(1, 0, 0), {0, 1, 0}, 1e-6f);
  // The bounds follow: corners (0,0), (2,0), (0,2) turn to (2,0), (2,2), (0,0), shifted by 6.
  checkBounds(snapshot.bounds, snapshot.origin, {6, 0, 0}, {8, 2, 0});
}

TEST_CASE("the bounds of what moves are those of all its vertices, bit for bit") {
  // More vertices than are looked at together, in no order, in order, and with one far vertex in the last
  // place.
  for (const int arrangement : {0, 1, 2}) {
    CAPTURE(arrangement);
    constexpr std::uint32_t kVertices = 10007;
    Scene scene = triangle();
    scene.positions.clear();
    RandomStream random(7, 0);
    for (std::uint32_t i = 0; i < kVertices; ++i) {
      const float along = arrangement == 1 ? static_cast<float>(i) / kVertices : random.uniform();
      scene.positions.emplace_back(along, random.uniform() - 0.3f, 1e-3f * random.uniform());
    }
    if (arrangement == 2) scene.positions.back() = {1.5f, -0.9f, 0.4f};
    scene.normals.assign(kVertices, {0, 0, 1});
    scene.texcoords.assign(kVertices, {0, 0});
    Object& object = scene.objects.front();
    object.vertexCount = kVertices;
    object.motion = RigidMotion{};
    object.motion->axis = glm::normalize(glm::dvec3(1, 2, -0.5));
    object.motion->angularSpeed = 0.7;
    object.motion->velocity = {0.1, -3.0, 0.2};
    object.motion->pivot = {0.3, 0.1, -2.0};
    constexpr double kTime = 1.3;
    const SceneSnapshot snapshot = snapshotOf(scene, kTime);
    glm::dmat4 toWorld =
        glm::translate(glm::dmat4(1.0), object.motion->pivot + object.motion->velocity * kTime);
    toWorld = glm::rotate(toWorld, 0.7 * kTime, object.motion->axis);
    toWorld = glm::translate(toWorld, -object.motion->pivot) * object.placement;
    glm::dvec3 low(1e300), high(-1e300);
    for (const glm::vec3& position : scene.positions) {
      const glm::dvec3 point(toWorld * glm::dvec4(glm::dvec3(position), 1.0));
      low = glm::min(low, point);
      high = glm::max(high, point);
    }
    CHECK(snapshot.bounds.low == glm::vec3(low - snapshot.origin));
    CHECK(snapshot.bounds.high == glm::vec3(high - snapshot.origin));
  }
}

TEST_CASE("the origin does not depend on the time") {
  Scene scene = triangle();
  scene.objects.push_back(scene.objects[0]);
  scene.objects[1].motion = RigidMotion{{0, 0, 1}, 1.0, {0, 0, 0}, {1, 2, 3}};
  CHECK(snapshotOf(scene, 0.0).origin == snapshotOf(scene, 17.3).origin);
}

TEST_CASE("the bounds for grids hold a turning object at every angle and stay where they are") {
  Scene scene = triangle();
  scene.objects.push_back(scene.objects[0]);
  scene.objects[1].motion = RigidMotion{{1, 2, 0.5}, 0.9, {0.5, 0.2, 0.1}, {0, 0, 0}};
  const SceneSnapshot first = snapshotOf(scene, 0.0);
  float slack = 1e9f;
  for (int i = 0; i < 200; ++i) {
    const SceneSnapshot now = snapshotOf(scene, 0.035 * i);
    CHECK(now.gridBounds.low == first.gridBounds.low);
    CHECK(now.gridBounds.high == first.gridBounds.high);
    for (int axis = 0; axis < 3; ++axis) {
      CHECK(now.bounds.low[axis] >= first.gridBounds.low[axis] - 1e-5f);
      CHECK(now.bounds.high[axis] <= first.gridBounds.high[axis] + 1e-5f);
      slack = std::min(slack, first.gridBounds.high[axis] - now.bounds.high[axis]);
    }
  }
  CHECK(slack < 0.01f);  // and no wider than the object reaches
}

TEST_CASE("the bounds of a whole turn about an axis are those of the circle, narrower along a tilted axis") {
  Scene scene = triangle();
  // The farthest corners are 2 m from the axis, in the plane z = 0.
  scene.objects[0].motion = RigidMotion{{0, 0, 1}, 1.0, {0, 0, 0}, {0, 0, 0}};
  auto [low, high] = sweptBoundsOf(scene, scene.objects[0]);
  checkNear(glm::vec3(low), {-2, -2, 0});
  checkNear(glm::vec3(high), {2, 2, 0});
  // Perpendicular to the axis (1, 0, 1) / sqrt 2, sqrt 2 m away: reach sqrt 2 sqrt(1 - a_i^2) per axis.
  scene.positions = {{0, 0, 0}, {1, 0, -1}, {0, 0, 0}};
  scene.objects[0].motion = RigidMotion{{1, 0, 1}, 1.0, {0, 0, 0}, {0, 0, 0}};
  std::tie(low, high) = sweptBoundsOf(scene, scene.objects[0]);
  checkNear(glm::vec3(low), {-1, -std::sqrt(2.0f), -1});
  checkNear(glm::vec3(high), {1, std::sqrt(2.0f), 1});
}

TEST_CASE("the bounds for grids hold every frame of a deforming object") {
  Scene scene = triangle();
  scene.objects[0].sequence = heights(scene, 1.0, {0.0f, 5.0f, -3.0f});
  const auto [low, high] = sweptBoundsOf(scene, scene.objects[0]);
  checkNear(glm::vec3(low), {0, 0, -3});
  checkNear(glm::vec3(high), {2, 2, 5});
  for (const double time : {0.0, 0.4, 1.0, 1.7, 2.5, 100.25}) {
    const SceneSnapshot now = snapshotOf(scene, time);
    checkBounds(now.gridBounds, now.origin, {0, 0, -3}, {2, 2, 5});
  }
}

TEST_CASE("the bounds for grids follow a travelling object in steps of an eighth of the scene") {
  Scene scene = triangle();
  scene.objects.push_back(scene.objects[0]);
  scene.objects[1].motion = RigidMotion{{0, 0, 1}, 0.0, {0, 0, 0}, {1, 0, 0}};
  // The scene is 2 m long: steps of 0.25 m, upwards along X alone.
  const auto high = [&](double time) {
    const SceneSnapshot now = snapshotOf(scene, time);
    CHECK(now.gridBounds.low.x + now.origin.x == Approx(0.0).margin(1e-6));
    CHECK(now.gridBounds.high.y + now.origin.y == Approx(2.0));
    CHECK(now.bounds.high.x <= now.gridBounds.high.x + 1e-6f);
    return static_cast<double>(now.gridBounds.high.x) + now.origin.x;
  };
  CHECK(high(0.0) == Approx(2.0));
  CHECK(high(0.1) == Approx(2.25));
  CHECK(high(0.2) == Approx(2.25));
  CHECK(high(0.3) == Approx(2.5));
  CHECK(high(100.0) == Approx(102.0));
  CHECK(high(0.1) == Approx(2.25));  // a function of the time alone
}

TEST_CASE("without motion the bounds for grids are the bounds, and without triangles both are empty") {
  Scene scene = triangle();
  const SceneSnapshot snapshot = snapshotOf(scene, 0.0);
  checkBounds(snapshot.gridBounds, {}, snapshot.bounds.low, snapshot.bounds.high);
  scene.objects.clear();
  const SceneSnapshot nothing = snapshotOf(scene, 0.0);
  CHECK((nothing.gridBounds.empty && nothing.bounds.empty));
  CHECK(nothing.origin == glm::dvec3(0));
}

TEST_CASE("normals of a stretched object stay perpendicular to its surface") {
  Scene scene = triangle();
  scene.objects[0].placement = glm::scale(glm::dmat4(1.0), {4, 1, 1});
  // The plane x + y = const, stretched by 4 along X, has the normal (1/4, 1): the inverse transpose.
  const glm::vec3 normal = glm::normalize(snapshotOf(scene, 0).objects[0].normalToWorld * glm::vec3(1, 1, 0));
  checkNear(normal, glm::normalize(glm::vec3(0.25f, 1, 0)));
}

TEST_CASE("deforming vertices are interpolated linearly and a loop returns to its first frame") {
  // Between the last frame and the first a loop goes on; without one the ends stay.
  const auto [loop, time, height] = GENERATE(table<bool, double, float>({
      {true, 0.0, 0.0f},
      {true, 0.25, 0.5f},
      {true, 0.75, 2.5f},
      {true, 1.25, 2.0f},
      {true, 1.5, 0.0f},
      {true, -0.25, 2.0f},
      {false, 1.25, 4.0f},
      {false, 100.0, 4.0f},
      {false, -1.0, 0.0f},
  }));
  CAPTURE(loop, time);
  Scene scene = triangle();
  scene.objects[0].sequence = heights(scene, 2.0, {0.0f, 1.0f, 4.0f});
  scene.objects[0].sequence->loop = loop;
  const SceneSnapshot snapshot = snapshotOf(scene, time);
  CHECK(snapshot.objects[0].positions.at(0).z == Approx(height).margin(1e-6));
  CHECK(snapshot.bounds.high.z + snapshot.origin.z == Approx(height).margin(1e-6));
}

TEST_CASE("interpolated normals have unit length") {
  Scene scene = triangle();
  VertexSequence sequence;
  sequence.framesPerSecond = 1.0;
  sequence.positions.assign(2, scene.positions);
  sequence.normals = {{{0, 0, 1}, {0, 0, 1}, {0, 0, 1}}, {{1, 0, 0}, {0, 1, 0}, {0, 0, -1}}};
  scene.objects[0].sequence = sequence;
  const SceneSnapshot snapshot = snapshotOf(scene, 0.5);
  for (const glm::vec3& normal : snapshot.objects[0].normals) CHECK(glm::length(normal) == Approx(1.0f));
}

TEST_CASE("a camera path is linear between its keys and rests outside") {
  Scene scene = triangle();
  scene.cameras[0].keys = {{1.0, {1, 1, 4}, {1, 1, 0}}, {3.0, {3, 1, 4}, {3, 1, 0}}};
  const auto eye = [&](double time) { return snapshotOf(scene, time).camera.eye.x + 1.0f; };
  CHECK(eye(0.0) == Approx(1.0));
  CHECK(eye(1.0) == Approx(1.0));
  CHECK(eye(1.5) == Approx(1.5));
  CHECK(eye(3.0) == Approx(3.0));
  CHECK(eye(9.0) == Approx(3.0));
}

TEST_CASE("lights are given relative to the origin with unit directions") {
  Scene scene = triangle();
  Light light;
  light.kind = LightKind::spot;
  light.position = {1, 5, 0};
  light.direction = {0, -3, 0};
  light.power = {1, 2, 3};
  scene.lights.push_back(light);
  const LightState state = snapshotOf(scene, 0).lights.at(0);
  checkNear(state.position, {0, 4, 0});
  checkNear(state.direction, {0, -1, 0});
}

TEST_CASE("an unknown camera is refused with the names that there are") {
  const Scene scene = triangle();
  CHECK(scene.camera().name == "main");
  CHECK_THROWS_MATCHES(snapshotOf(scene, 0, "mian"), Error, Tells("mian", "main", "mean", "main"));
}

TEST_CASE("traits tell what is there, not what is named") {
  Scene scene = triangle();
  SceneTraits traits = SceneTraits::of(scene);
  CHECK(traits.triangles);
  CHECK_FALSE((traits.glossy || traits.emission || traits.movingGeometry || traits.environment));
  CHECK(traits.areaLights + traits.directionalLights == 0);
  Material gold;
  gold.specular = glm::vec3(0.5f);
  gold.emission = glm::vec3(1.0f);
  scene.materials.push_back(gold);  // used by no part
  CHECK_FALSE(SceneTraits::of(scene).glossy);
  scene.objects[0].parts[0].material = 1;
  scene.objects[0].motion = RigidMotion{};
  scene.environment = glm::vec3(0.1f);
  scene.lights.resize(2);
  scene.lights[0].power = glm::vec3(1);  // the other one is dark
  traits = SceneTraits::of(scene);
  CHECK((traits.glossy && traits.emission && traits.movingGeometry && traits.environment));
  CHECK((traits.areaLights == 1 && traits.directionalLights == 1));
  const SceneTraits everything = SceneTraits::everything();
  CHECK((everything.textures && everything.masks && everything.medium && everything.movingCamera));
}

TEST_CASE("the normal of an object that its placement flattens is finite and across the plane") {
  Scene scene;
  scene.cameras.push_back(Camera{});
  Object object;
  object.name = "flat";
  object.placement = glm::scale(glm::dmat4(1.0), glm::dvec3(2.0, 3.0, 0.0));
  scene.objects.push_back(object);
  const glm::vec3 normal = snapshotOf(scene, 0.0).objects[0].normalToWorld * glm::vec3(0.3f, 0.2f, 0.9f);
  CHECK(glm::normalize(normal) == glm::vec3(0, 0, 1));
}
