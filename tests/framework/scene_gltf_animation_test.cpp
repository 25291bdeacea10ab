// glTF models that move: nodes, morph targets, skins and cameras.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "framework/one_model.h"
#include "lumivox/scene/model_animation.h"
#include "lumivox/scene/models.h"
#include "support/facts.h"
#include "support/gltf_files.h"

using namespace lumivox;
using lumivox::test::Tells;
using test::GltfWriter, test::OneModel, test::triangleBody;

namespace {

/// An animation with one channel: `times` and `values` of `type` drive `path` of node 0.
std::string animation(GltfWriter& writer, const std::string& path, const std::vector<float>& times,
                      const std::vector<float>& values, const std::string& type,
                      const std::string& interpolation = "LINEAR", const std::string& name = "move") {
  const int input =
      writer.numbers(times, "SCALAR", fmt::format(R"(,"min":[{}],"max":[{}])", times.front(), times.back()));
  const int output = writer.numbers(values, type);
  return fmt::format(R"({{"name":"{}","channels":[{{"sampler":0,"target":{{"node":0,"path":"{}"}}}}],)"
                     R"("samplers":[{{"input":{},"output":{},"interpolation":"{}"}}]}})",
                     name, path, input, output, interpolation);
}

/// Where vertex `vertex` of the scene's first object is at a time, m.
glm::dvec3 placeAt(const Scene& scene, double time, std::uint32_t vertex = 0) {
  const SceneSnapshot snapshot = snapshotOf(scene, time);
  const ObjectState& state = snapshot.objects.at(0);
  const glm::vec3 local = state.positions.empty() ? scene.positions.at(scene.objects[0].firstVertex + vertex)
                                                  : state.positions.at(vertex);
  return glm::dvec3(state.toWorld * glm::vec4(local, 1.0f)) + snapshot.origin;
}

bool near(const glm::dvec3& a, const glm::dvec3& b) {
  return glm::distance(a, b) < 1e-5;
}

std::string moving(const std::string& interpolation, const std::vector<float>& values) {
  GltfWriter writer;
  const std::string body = triangleBody(writer);
  return writer.gltf(body + ",\"animations\":[" +
                     animation(writer, "translation", {0, 1, 2}, values, "VEC3", interpolation) + "]");
}

/// A bar along y of 5 rings, whose upper joint, at y = 2, bends about z by a quarter turn in a second.
std::string skinnedBar() {
  GltfWriter writer;
  std::vector<float> positions, weights;
  std::vector<std::uint8_t> joints;
  std::vector<std::uint16_t> indices;
  for (int ring = 0; ring <= 4; ++ring) {
    for (const float x : {-0.5f, 0.5f}) {
      positions.insert(positions.end(), {x, static_cast<float>(ring), 0});
      joints.insert(joints.end(), {0, 1, 0, 0});
      const float upper = ring < 2 ? 0.0f : ring == 2 ? 0.5f : 1.0f;
      weights.insert(weights.end(), {1 - upper, upper, 0, 0});
    }
    const auto first = static_cast<std::uint16_t>(2 * ring);
    if (ring < 4)
      for (const int corner : {0, 1, 3, 0, 3, 2})
        indices.push_back(static_cast<std::uint16_t>(first + corner));
  }
  const int p = writer.numbers(positions, "VEC3"), j = writer.numbers(joints, "VEC4"),
            w = writer.numbers(weights, "VEC4"), i = writer.numbers(indices, "SCALAR");
  const int bind = writer.numbers<float>(
      {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -2, 0, 1},
      "MAT4");
  const float half = std::sqrt(0.5f);
  std::string turn = animation(writer, "rotation", {0, 1}, {0, 0, 0, 1, 0, 0, half, half}, "VEC4");
  turn.replace(turn.find("\"node\":0"), 8, "\"node\":2");
  return writer.gltf(fmt::format(
      R"("nodes":[{{"name":"bar","mesh":0,"skin":0,"translation":[100,0,0]}},)"
      R"({{"name":"lower","children":[2]}},{{"name":"upper","translation":[0,2,0]}}],)"
      R"("meshes":[{{"primitives":[{{"attributes":{{"POSITION":{},"JOINTS_0":{},"WEIGHTS_0":{}}},"indices":{}}}]}}],)"
      R"("skins":[{{"joints":[1,2],"inverseBindMatrices":{}}}],"animations":[{}])",
      p, j, w, i, bind, turn));
}

}  // namespace

TEST_CASE("a node moves linearly, in steps or along a cubic between its keys, and starts again at the end") {
  const std::vector<float> values{0, 0, 0, 4, 0, 0, 4, 2, 0};
  const Scene linear = OneModel("m.gltf", moving("LINEAR", values)).load();
  CHECK(SceneTraits::of(linear).movingGeometry);
  CHECK(near(placeAt(linear, 0.25), {1, 0, 0}));
  CHECK(near(placeAt(linear, 1.5), {4, 1, 0}));
  CHECK(near(placeAt(linear, 2.25), {1, 0, 0}));  // again
  CHECK(near(placeAt(linear, -0.5), {4, 1, 0}));
  const Scene once = OneModel("m.gltf", moving("LINEAR", values), "loop off").load();
  CHECK(near(placeAt(once, 5.0), {4, 2, 0}));
  CHECK(near(placeAt(once, -5.0), {0, 0, 0}));
  const Scene step = OneModel("m.gltf", moving("STEP", values)).load();
  CHECK(near(placeAt(step, 0.99), {0, 0, 0}));
  CHECK(near(placeAt(step, 1.0), {4, 0, 0}));
  // In-tangent, value, out-tangent of three keys; Hermite at t = 1/2 of the first span:
  // value (0 + 4)/2 + (out 8 - in 0)/8 = 3 along x; along y (0 - (-16))/8 = 2.
  const Scene cubic = OneModel("m.gltf", moving("CUBICSPLINE", {0, 0, 0, 0, 0, 0, 8, 0, 0, 0, -16, 0, 4, 0,
                                                                0, 0, 0, 0, 0, 0, 0, 4, 2, 0, 0,   0, 0}))
                          .load();
  CHECK(near(placeAt(cubic, 0.5), {3, 2, 0}));
  CHECK(near(placeAt(cubic, 1.0), {4, 0, 0}));
}

TEST_CASE(
    "a rotation goes along the shortest arc, below the mesh block's placement and the text's own motion") {
  GltfWriter writer;
  const std::string body = triangleBody(writer);
  const float half = std::sqrt(0.5f);
  const std::string file =
      writer.gltf(body + ",\"animations\":[" +
                  animation(writer, "rotation", {0, 1}, {0, 0, 0, 1, 0, 0, -half, -half}, "VEC4") + "]");
  const Scene scene =
      OneModel("m.gltf", file, "scale 2  translate 0 0 7", "animate m { translate 0 1 0 }").load();
  // An eighth turn about z at half the time; the quaternion's sign does not count.
  const double side = 2 * std::sqrt(0.5);
  CHECK(near(placeAt(scene, 0.5, 1), {side, side + 0.5, 7}));
}

TEST_CASE("bounds for grids hold everything that a model covers while it moves") {
  for (const Scene& scene : {OneModel("m.gltf", moving("LINEAR", {0, 0, 0, 4, 0, 0, 4, 2, 0})).load(),
                             OneModel("m.gltf", skinnedBar()).load()}) {
    const SceneSnapshot first = snapshotOf(scene, 0.0);
    for (double time = 0.0; time < 3.0; time += 0.0625) {
      const SceneSnapshot snapshot = snapshotOf(scene, time);
      CHECK(snapshot.gridBounds.low == first.gridBounds.low);
      CHECK(glm::all(glm::lessThanEqual(snapshot.gridBounds.low, snapshot.bounds.low + 1e-4f)));
      CHECK(glm::all(glm::greaterThanEqual(snapshot.gridBounds.high, snapshot.bounds.high - 1e-4f)));
    }
  }
}

TEST_CASE("bounds hold a short leap in an animation of a thousand keys") {
  GltfWriter writer;
  const std::string body = triangleBody(writer);
  std::vector<float> times, values;
  for (int key = 0; key < 1000; ++key) {
    times.push_back(0.04f * static_cast<float>(key));
    values.insert(values.end(), {0.0f, key == 501 ? 7.0f : 0.0f, 0.0f});
  }
  const Scene scene =
      OneModel("m.gltf", writer.gltf(body + ",\"animations\":[" +
                                     animation(writer, "translation", times, values, "VEC3") + "]"))
          .load();
  const SceneSnapshot snapshot = snapshotOf(scene, 0.0);
  CHECK(snapshot.gridBounds.high.y + snapshot.origin.y >= 7.0);
}

TEST_CASE("morph targets move vertices and normals by their weights, which an animation drives") {
  GltfWriter writer;
  const int moved = writer.numbers<float>({0, 0, 1, 0, 0, 0, 0, 0, 0}, "VEC3");
  const int other = writer.numbers<float>({0, 0, 0, 2, 0, 0, 0, 0, 0}, "VEC3");
  const std::string body =
      triangleBody(writer, R"(,"weights":[0,0.5])",
                   fmt::format(R"(,"targets":[{{"POSITION":{}}},{{"POSITION":{}}}])", moved, other));
  const Scene still = OneModel("m.gltf", writer.gltf(body)).load();
  CHECK(!SceneTraits::of(still).movingGeometry);
  CHECK(near(placeAt(still, 0.0, 1), {2, 0, 0}));
  const Scene scene =
      OneModel("m.gltf", writer.gltf(body + ",\"animations\":[" +
                                     animation(writer, "weights", {0, 2}, {0, 0, 1, 1}, "SCALAR") + "]"))
          .load();
  CHECK(deforms(scene.objects.at(0)));
  CHECK(near(placeAt(scene, 1.0, 0), {0, 0, 0.5}));
  CHECK(near(placeAt(scene, 1.0, 1), {2, 0, 0}));
  const ObjectState state = snapshotOf(scene, 1.0).objects.at(0);
  // The triangle (0,0,1/2) (2,0,0) (0,1,0): the plane x/4 + y/2 + z = 1/2. Smooth normals are linear in the
  // weights, so between the ends they are near, not equal.
  CHECK(glm::dot(state.normals.at(0), glm::normalize(glm::vec3(0.25f, 0.5f, 1.0f))) > 0.97f);
  for (const glm::vec3& normal : state.normals) CHECK(glm::length(normal) == Approx(1.0f));
}

TEST_CASE("a skin moves vertices with the joints by their weights, wherever the node itself is") {
  const Scene scene = OneModel("m.gltf", skinnedBar()).load();
  // Vertices stand in the order of the triangles: 0 1 3 2, 5 4, 7 6, ...
  CHECK(near(placeAt(scene, 0.0, 8), {0.5, 4, 0}));
  // At the end the upper half lies along -x from the joint at (0, 2).
  const Scene once = OneModel("m.gltf", skinnedBar(), "loop off").load();
  CHECK(near(placeAt(once, 1.0, 1), {0.5, 0, 0}));
  CHECK(near(placeAt(once, 1.0, 8), {-2, 2.5, 0}));
  // Half of each joint in the middle ring: the mean of (0.5, 2) and (0, 2.5).
  CHECK(near(placeAt(once, 1.0, 4), {0.25, 2.25, 0}));
}

TEST_CASE("the first animation plays unless the mesh block names another, and an unknown name is an error") {
  GltfWriter writer;
  const std::string body = triangleBody(writer);
  const std::string file = writer.gltf(
      body + ",\"animations\":[" +
      animation(writer, "translation", {0, 1}, {0, 0, 0, 1, 0, 0}, "VEC3", "LINEAR", "walk") + "," +
      animation(writer, "translation", {0, 1}, {0, 0, 0, 0, 9, 0}, "VEC3", "LINEAR", "jump") + "]");
  CHECK(near(placeAt(OneModel("m.gltf", file).load(), 0.5), {0.5, 0, 0}));
  CHECK(near(placeAt(OneModel("m.gltf", file, "animation jump").load(), 0.5), {0, 4.5, 0}));
  CHECK_THAT(OneModel("m.gltf", file, "animation jum").error(),
             Tells("m.gltf", "jum", "walk", "mean 'jump'"));
  CHECK_THAT(OneModel("m.ply", "", "animation jump").error(), Tells("animation", "glTF"));
  CHECK_THAT(OneModel("m.gltf", file, "rate 3").error(), Tells("rate", "sequence"));
}

TEST_CASE("objects that model animations move are models of their own") {
  GltfWriter writer;
  const std::string body = triangleBody(writer, R"(,"children":[1]},{"mesh":0)");
  const Scene scene =
      OneModel("m.gltf",
               writer.gltf(body + ",\"animations\":[" +
                           animation(writer, "translation", {0, 1}, {0, 0, 0, 1, 0, 0}, "VEC3") + "]"))
          .load();
  CHECK(modelsOf(scene) == std::vector<std::uint32_t>{1, 2});
  const SceneSnapshot snapshot = snapshotOf(scene, 0.5);
  CHECK(snapshot.objects[0].toWorld == snapshot.objects[1].toWorld);  // the child moves with its parent
}

TEST_CASE(
    "a camera of the file gives a camera of the text its place and angle of view, and its motion as keys") {
  GltfWriter writer;
  std::string body = triangleBody(writer);
  const float half = std::sqrt(0.5f);
  body.replace(
      body.find("\"nodes\":[{"), 10,
      fmt::format(R"("cameras":[{{"type":"perspective","perspective":{{"yfov":0.5,"znear":0.1}}}}],"nodes":[)"
                  R"({{"name":"eye","camera":0,"translation":[0,0,4],"rotation":[0,{0},0,{0}]}},{{)",
                  half));
  body.replace(body.find("\"nodes\":[0]"), 11, "\"nodes\":[0,1]");
  const std::string camera = "camera walk { from m/eye  resolution 64 32 }";
  const Camera still = OneModel("m.gltf", writer.gltf(body), "scale 2", camera).load().camera("walk");
  CHECK(near(still.eye, {0, 0, 8}));
  CHECK(near(glm::normalize(still.target - still.eye), {-1, 0, 0}));  // a quarter turn to the left
  CHECK(still.fov == Approx(0.5));
  CHECK((still.width == 64 && still.keys.empty()));
  const Scene scene =
      OneModel("m.gltf",
               writer.gltf(body + ",\"animations\":[" +
                           animation(writer, "translation", {0, 2}, {0, 0, 4, 2, 0, 4}, "VEC3") + "]"),
               "", camera)
          .load();
  CHECK(SceneTraits::of(scene).movingCamera);
  const SceneSnapshot snapshot = snapshotOf(scene, 1.0, "walk");
  CHECK(near(glm::dvec3(snapshot.camera.eye) + snapshot.origin, {1, 0, 4}));
  CHECK_THAT(OneModel("m.gltf", writer.gltf(body), "", "camera walk { from m/ey }").error(),
             Tells("camera", "m/ey", "mean 'm/eye'"));
  CHECK_THAT(OneModel("m.gltf", writer.gltf(body), "", "camera walk { from n/eye }").error(),
             Tells("mesh 'n'"));
  CHECK_THAT(OneModel("m.gltf", writer.gltf(body), "", "camera walk { from m/eye  fov 40 deg }").error(),
             Tells("fov", "from"));
}

TEST_CASE("each way in which an animation can be wrong gives one error with its JSON pointer") {
  const auto broken = [](const std::string& from, const std::string& to,
                         const std::vector<float>& times = {0, 1, 2}) {
    GltfWriter writer;
    const std::string body = triangleBody(writer);
    std::string file =
        writer.gltf(body + ",\"animations\":[" +
                    animation(writer, "translation", times, {0, 0, 0, 4, 0, 0, 4, 2, 0}, "VEC3") + "]");
    if (!from.empty()) file.replace(file.find(from), from.size(), to);
    return OneModel("m.gltf", file).error();
  };
  CHECK_THAT(broken("\"translation\"", "\"colour\""),
             Tells("/animations/0/channels/0/target/path", "colour"));
  CHECK_THAT(broken("\"node\":0", "\"node\":7"), Tells("/animations/0/channels/0/target/node", 7));
  CHECK_THAT(broken("\"sampler\":0", "\"sampler\":1"), Tells("/animations/0/channels/0/sampler", 1));
  CHECK_THAT(broken("LINEAR", "BEZIER"), Tells("interpolation", "BEZIER"));
  CHECK_THAT(broken("LINEAR", "CUBICSPLINE"), Tells("/accessors/3", 9, 3));
  CHECK_THAT(broken("\"output\":3", "\"output\":2"), Tells("/accessors/2", "values", 3));
  CHECK_THAT(broken("", "", {0, 2, 1}), Tells("/accessors/2", "rise"));
  std::string bar = skinnedBar();
  bar.replace(bar.find("\"joints\":[1,2]"), 14, "\"joints\":[1,9]");
  CHECK_THAT(OneModel("m.gltf", bar).error(), Tells("/skins/0/joints/1", 9));
  bar = skinnedBar();
  bar.replace(bar.find("\"joints\":[1,2]"), 14, "\"joints\":[1]");
  CHECK_THAT(OneModel("m.gltf", bar).error(), Tells("/skins/0", "joint 1"));
  bar = skinnedBar();
  bar.replace(bar.find(",\"WEIGHTS_0\":2"), 14, "");
  CHECK_THAT(OneModel("m.gltf", bar).error(), Tells("/meshes/0/primitives/0/attributes", "WEIGHTS_0"));
}
