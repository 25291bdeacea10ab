// Surface elements: trees, areas, and how they follow what moves.
#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <map>

#include "lumivox/base/error.h"
#include "lumivox/base/log.h"
#include "support/facts.h"
#include "support/half_masked_sheet.h"
#include "support/meshes.h"
#include "support/placed.h"
#include "support/scene_builder.h"
#include "support/surface_elements.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

/// A tree of pointers: four nodes of a level under one of the next, as they come.
struct PointerNode {
  std::uint32_t number = 0;
  PointerNode* parent = nullptr;
  std::vector<PointerNode*> children;
};

struct Elements {
  SurfaceElements made;
  const ElementState& state() const { return *made.state; }
  const ElementTree& tree() const { return *made.tree; }
};

Elements elementsOf(const Scene& scene, const Settings& settings, double time = 0.0) {
  return {LonePass("implicit_visibility.elements", scene, settings, time).out<SurfaceElements>("elements")};
}

double areaOf(const Elements& elements) {
  double sum = 0.0;
  for (std::uint32_t leaf = 0; leaf < elements.tree().leafCount; ++leaf)
    sum += static_cast<double>(elements.state().area[leaf]);
  return sum;
}

void checkOutlineAreas(const Elements& made) {
  REQUIRE(made.tree().leafCount > 0);
  for (std::uint32_t leaf = 0; leaf < made.tree().leafCount; ++leaf) {
    const std::span<const glm::vec3> corners = made.state().outline(made.tree(), leaf);
    REQUIRE(corners.size() >= 3);
    glm::vec3 twice(0.0f);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      twice += glm::cross(corners[i], corners[(i + 1) % corners.size()]);
      CHECK(std::abs(glm::dot(corners[i], made.state().normal[leaf])) < 1e-4f * made.state().reach[leaf]);
      CHECK(glm::length(corners[i]) <= made.state().reach[leaf]);
    }
    CHECK(0.5f * glm::length(twice) == Approx(made.state().area[leaf]).epsilon(1e-4));
  }
}

Scene boxAndSphere() {
  SceneBuilder builder;
  builder.box({0, 0, 0}, {3, 1, 2}, builder.lambert(0.5f), true);
  builder.mesh(sphereCorners(8), builder.lambert(0.3f));
  return builder.scene;
}

double surfaceOf(const Scene& scene) {
  double area = 0.0;
  for (std::size_t i = 0; i < scene.indices.size(); i += 3) {
    const auto at = [&](std::size_t k) { return glm::dvec3(scene.positions[scene.indices[i + k]]); };
    area += 0.5 * glm::length(glm::cross(at(1) - at(0), at(2) - at(0)));
  }
  return area;
}

/// A sheet of one square metre whose vertices are shared, and which deforms to `places`.
Scene deforming(const std::vector<std::vector<glm::vec3>>& frames) {
  SceneBuilder builder;
  Object& sheet = builder.quad({0, 0, 0}, {0, 0, 1}, {1, 0, 0}, builder.lambert(0.5f));
  VertexSequence sequence;
  sequence.framesPerSecond = 1.0;
  sequence.positions = frames;
  sequence.normals.assign(frames.size(), std::vector<glm::vec3>(4, glm::vec3(0, 1, 0)));
  sheet.sequence = sequence;
  return builder.scene;
}

std::vector<glm::vec3> sheetCorners(float width) {
  return {{0, 0, 0}, {0, 0, 1}, {width, 0, 1}, {width, 0, 0}};
}

/// A square metre in so many squares a side, two triangles each.
Scene sheet(int cuts) {
  SceneBuilder builder;
  std::vector<glm::vec3> corners;
  for (int j = 0; j < cuts; ++j)
    for (int i = 0; i < cuts; ++i) {
      const auto at = [&](int x, int z) {
        return glm::vec3(static_cast<float>(x) / static_cast<float>(cuts), 0,
                         static_cast<float>(z) / static_cast<float>(cuts));
      };
      const glm::vec3 a = at(i, j), b = at(i, j + 1), c = at(i + 1, j + 1), d = at(i + 1, j);
      corners.insert(corners.end(), {a, b, c, a, c, d});
    }
  builder.mesh(corners, builder.lambert(0.5f));
  return builder.scene;
}

}  // namespace

TEST_CASE("numbers of nodes alone tell parents and children, for trees of 1 to 85 leaves") {
  for (std::uint32_t leaves = 1; leaves <= 85; ++leaves) {
    std::vector<std::unique_ptr<PointerNode>> nodes;
    std::vector<PointerNode*> level;
    const auto add = [&] {
      nodes.push_back(std::make_unique<PointerNode>());
      nodes.back()->number = static_cast<std::uint32_t>(nodes.size()) - 1;
      return nodes.back().get();
    };
    for (std::uint32_t i = 0; i < leaves; ++i) level.push_back(add());
    while (level.size() > 1) {
      std::vector<PointerNode*> next;
      for (std::size_t i = 0; i < level.size(); ++i) {
        if (i % 4 == 0) next.push_back(add());
        next.back()->children.push_back(level[i]);
        level[i]->parent = next.back();
      }
      level = next;
    }
    const QuadtreeNumbers numbers(leaves);
    CAPTURE(leaves);
    REQUIRE(numbers.nodeCount() == nodes.size());
    for (const auto& node : nodes) {
      CHECK(numbers.parent(node->number) == (node->parent != nullptr ? node->parent->number : kNoElement));
      REQUIRE(numbers.childCount(node->number) == node->children.size());
      for (std::uint32_t k = 0; k < node->children.size(); ++k)
        CHECK(numbers.firstChild(node->number) + k == node->children[k]->number);
    }
  }
  const QuadtreeNumbers published(16);
  CHECK(published.nodeCount() == 21);
  CHECK(published.levelFirst(1) == 16);
  CHECK(published.parent(15) == 19);
  CHECK(published.parent(19) == 20);
}

TEST_CASE("areas of elements sum to that of the surface, by texels of the atlas and by vertices") {
  const Scene scene = boxAndSphere();
  const double surface = surfaceOf(scene);
  for (const double count : {64.0, 1000.0, 5000.0}) {
    const Elements texels = elementsOf(scene, {{"elements", count}});
    CAPTURE(count, texels.tree().leafCount);
    CHECK(areaOf(texels) == Approx(surface).epsilon(1e-3));
    CHECK(texels.state().area[texels.tree().root] == Approx(surface).epsilon(1e-3));
  }
  const Elements vertices = elementsOf(scene, {{"source", "vertices"}});
  CHECK(areaOf(vertices) == Approx(surface).epsilon(1e-5));
  CHECK(vertices.tree().leafCount == scene.positions.size());
}

TEST_CASE(
    "outlines of elements have the areas of their elements, turned, stretched, and with holes of masks") {
  Scene stretched = deforming({sheetCorners(1.0f), sheetCorners(3.0f)});
  for (const char* areas : {"now", "rest"})
    for (const double count : {16.0, 100.0}) {
      const Elements made = elementsOf(stretched, {{"elements", count}, {"areas", areas}}, 0.7);
      checkOutlineAreas(made);
    }
  Scene turned = boxAndSphere();
  turned.objects.pop_back();  // the sphere bends within its texels, which keep their discs
  RigidMotion motion;
  motion.axis = glm::normalize(glm::dvec3(1, 2, 3));
  motion.angularSpeed = 0.9;
  for (Object& object : turned.objects) object.motion = motion;
  checkOutlineAreas(elementsOf(turned, {{"elements", 150}}, 0.7));
  SceneBuilder builder;
  addHalfMaskedSheet(builder);
  checkOutlineAreas(elementsOf(builder.scene, {{"elements", 150}}));
}

TEST_CASE("about as many elements are made as were asked for, an object's part by a power of its area") {
  const Scene scene = boxAndSphere();
  for (const double count : {500.0, 4096.0, 30000.0}) {
    const double made = elementsOf(scene, {{"elements", count}}).tree().leafCount;
    CHECK(made > 0.8 * count);
    CHECK(made < 1.25 * count);
  }
  SceneBuilder builder;
  builder.quad({0, 0, 0}, {0, 0, 100}, {100, 0, 0}, builder.lambert(0.5f));
  builder.quad({0, 5, 0}, {0, 0, 10}, {10, 0, 0}, builder.lambert(0.5f));
  for (const double share : {0.0, 0.5, 1.0}) {
    const Elements made = elementsOf(builder.scene, {{"elements", 4400}, {"share", share}});
    double small = 0.0;
    for (std::uint32_t leaf = 0; leaf < made.tree().leafCount; ++leaf)
      small += made.tree().objectOfNode[leaf] == 1;
    // Areas are as 100 : 1, so that parts are as 100^share : 1.
    CHECK(small / made.tree().leafCount == Approx(1.0 / (1.0 + std::pow(100.0, share))).epsilon(0.25));
  }
}

TEST_CASE("objects too small for an element have one each, and leave a large one its part") {
  SceneBuilder builder;
  builder.quad({0, 0, 0}, {0, 0, 100}, {100, 0, 0}, builder.lambert(0.5f));
  const int grey = builder.lambert(0.5f);
  constexpr int kObjects = 1000;
  for (int i = 0; i < kObjects; ++i)
    builder.quad({static_cast<float>(i % 40), 5.0f, static_cast<float>(i / 40)}, {0, 0, 0.7f},
                 {i % 2 == 0 ? 0.7f : 0.2f, 0, 0}, grey);
  const Elements made = elementsOf(builder.scene, {{"elements", 400}});
  std::vector<int> counts(kObjects + 1, 0);
  for (std::uint32_t leaf = 0; leaf < made.tree().leafCount; ++leaf) ++counts[made.tree().objectOfNode[leaf]];
  // 400, in a square whose sides are multiples of four; by its part among all objects it would be 67.
  CHECK(counts[0] >= 16 * 16);
  CHECK(counts[0] <= 24 * 24);
  CHECK(std::count(counts.begin() + 1, counts.end(), 1) == kObjects);
}

TEST_CASE(
    "a node lies at the middle of its leaves, by area, and reaches over all of their outlines and discs") {
  const Elements made = elementsOf(boxAndSphere(), {{"elements", 150}});
  const ElementTree& tree = made.tree();
  const ElementState& state = made.state();
  std::vector<std::vector<std::uint32_t>> leaves(tree.nodeCount);
  for (std::uint32_t leaf = 0; leaf < tree.leafCount; ++leaf)
    for (std::uint32_t node = leaf; node != kNoElement; node = tree.parents[node])
      leaves[node].push_back(leaf);
  REQUIRE(leaves[tree.root].size() == tree.leafCount);
  // The box has outlines; the sphere bends by more than they allow within many of its texels, which have
  // discs.
  const auto isDisc = [&](std::uint32_t leaf) { return state.outline(tree, leaf).empty(); };
  std::uint32_t discs = 0;
  for (std::uint32_t leaf = 0; leaf < tree.leafCount; ++leaf) discs += isDisc(leaf) ? 1u : 0u;
  CHECK(discs >= 5);
  CHECK(discs < tree.leafCount);
  for (std::uint32_t node = 0; node < tree.nodeCount; ++node) {
    glm::dvec3 middle(0.0);
    double area = 0.0;
    for (const std::uint32_t leaf : leaves[node]) {
      middle += static_cast<double>(state.area[leaf]) * glm::dvec3(state.position[leaf]);
      area += static_cast<double>(state.area[leaf]);
    }
    CHECK(state.area[node] == Approx(area).epsilon(1e-4));
    CHECK(glm::length(middle / area - glm::dvec3(state.position[node])) < 1e-4);
    for (const std::uint32_t leaf : leaves[node]) {
      for (const glm::vec3& corner : state.outline(tree, leaf))
        CHECK(glm::distance(state.position[leaf] + corner, state.position[node]) <=
              state.reach[node] * 1.0001f);
      if (isDisc(leaf))
        CHECK(glm::distance(state.position[leaf], state.position[node]) + state.radius[leaf] <=
              state.reach[node] * 1.0001f);
    }
  }
}

TEST_CASE("elements of a body that turns and travels are those of a body that was built there") {
  Scene moving = boxAndSphere();
  const double time = 0.7;
  for (Object& object : moving.objects) {
    RigidMotion motion;
    motion.axis = glm::normalize(glm::dvec3(1, 2, 3));
    motion.angularSpeed = 0.9;
    motion.velocity = {2, 0.5, -1};
    object.motion = motion;
  }
  const SceneSnapshot snapshot = snapshotOf(moving, time);
  Scene built = boxAndSphere();
  for (std::size_t i = 0; i < built.objects.size(); ++i) {
    built.objects[i].placement = glm::dmat4(snapshot.objects[i].toWorld);
    built.objects[i].placement[3] += glm::dvec4(snapshot.origin, 0.0);
  }
  const Elements a = elementsOf(moving, {{"elements", 600}}, time),
                 b = elementsOf(built, {{"elements", 600}});
  REQUIRE(a.tree().leafCount == b.tree().leafCount);
  const glm::vec3 shift(snapshot.origin - snapshotOf(built, 0.0).origin);
  // Leaves of an object may come in another order of charts: by place.
  double worst = 0.0;
  for (std::uint32_t i = 0; i < a.tree().leafCount; ++i) {
    double nearest = 1e9;
    for (std::uint32_t k = 0; k < b.tree().leafCount; ++k)
      nearest =
          std::min<double>(nearest, glm::distance(a.state().position[i] + shift, b.state().position[k]) +
                                        glm::distance(a.state().normal[i], b.state().normal[k]) +
                                        std::abs(a.state().area[i] - b.state().area[k]));
    worst = std::max(worst, nearest);
  }
  CHECK(worst < 1e-5);
}

TEST_CASE("elements follow a deforming sheet, with the areas of the moment or of the rest") {
  const Scene scene = deforming({sheetCorners(1.0f), sheetCorners(3.0f)});
  for (const std::string source : {"atlas", "vertices"}) {
    CAPTURE(source);
    const Settings now{{"elements", 64}, {"source", source}};
    Settings rest = now;
    rest.emplace_back("areas", "rest");
    CHECK(areaOf(elementsOf(scene, now, 0.0)) == Approx(1.0).epsilon(1e-4));
    CHECK(areaOf(elementsOf(scene, now, 0.5)) == Approx(2.0).epsilon(1e-4));
    CHECK(areaOf(elementsOf(scene, rest, 0.5)) == Approx(1.0).epsilon(1e-4));
  }
  const Elements before = elementsOf(scene, {{"elements", 64}}, 0.0),
                 after = elementsOf(scene, {{"elements", 64}}, 0.5);
  for (std::uint32_t leaf = 0; leaf < before.tree().leafCount; ++leaf) {
    const glm::vec3 origin(snapshotOf(scene, 0.0).origin);
    const glm::vec3 place = before.state().position[leaf] + origin;
    CHECK(glm::distance(after.state().position[leaf] + origin, place * glm::vec3(2, 1, 1)) < 1e-5f);
  }
}

TEST_CASE("a sheet that shrinks to a point has elements without area, and numbers everywhere") {
  const Scene scene = deforming({sheetCorners(1.0f), std::vector<glm::vec3>(4, glm::vec3(0.5f, 0, 0.5f))});
  for (const std::string source : {"atlas", "vertices"})
    for (const std::string areas : {"now", "rest"}) {
      const Elements made = elementsOf(scene, {{"elements", 64}, {"source", source}, {"areas", areas}}, 1.0);
      for (std::uint32_t node = 0; node < made.tree().nodeCount; ++node) {
        CHECK(made.state().area[node] == 0.0f);
        CHECK(made.state().radius[node] == 0.0f);
        CHECK(std::isfinite(made.state().position[node].x + made.state().normal[node].x +
                            made.state().reach[node]));
      }
    }
}

TEST_CASE("the same elements stand on two large triangles and on twenty thousand tiny ones") {
  const Elements large = elementsOf(sheet(1), {{"elements", 256}}),
                 tiny = elementsOf(sheet(100), {{"elements", 256}});
  REQUIRE(large.tree().leafCount == 256);
  REQUIRE(tiny.tree().leafCount == 256);
  CHECK(tiny.tree().segments.size() == 1);
  for (std::uint32_t leaf = 0; leaf < 256; ++leaf) {
    CHECK(glm::distance(large.state().position[leaf], tiny.state().position[leaf]) < 1e-4f);
    CHECK(tiny.state().area[leaf] == Approx(1.0 / 256.0).epsilon(1e-3));
  }
}

TEST_CASE(
    "the same elements stand on two large triangles and on a million tiny ones; a million vertices are refused",
    "[.]") {
  const Scene scene = sheet(708);
  REQUIRE(scene.triangleCount() > 1000000);
  const Elements large = elementsOf(sheet(1), {{"elements", 4096}}),
                 tiny = elementsOf(scene, {{"elements", 4096}});
  REQUIRE(large.tree().leafCount == tiny.tree().leafCount);
  for (std::uint32_t leaf = 0; leaf < large.tree().leafCount; ++leaf) {
    CHECK(glm::distance(large.state().position[leaf], tiny.state().position[leaf]) < 1e-4f);
    CHECK(tiny.state().area[leaf] == Approx(large.state().area[leaf]).epsilon(1e-3));
  }
  const Elements vertices = elementsOf(scene, {{"source", "vertices"}});
  CHECK(vertices.tree().leafCount == scene.positions.size());
  LonePass links("implicit_visibility.create_links", scene, {{"bins", 16}});
  CHECK_THROWS_MATCHES(links.in("elements", vertices.made).run(), Error, Tells("elements", "6 x 16 x 16"));
}

TEST_CASE("holes of masks have no elements, and an element has the mean colour of its piece of texture") {
  SceneBuilder builder;
  Material cut, patterned;
  cut.diffuse = patterned.diffuse = glm::vec3(1.0f);
  cut.maskTexture = 0;
  patterned.diffuseTexture = 1;
  builder.scene.textures.push_back({"left half", 2, 1, true, {1.0f, 0.0f}});
  builder.scene.textures.push_back({"checkered", 2, 2, false, {1, 1, 1, 0, 0, 0, 0, 0, 0, 1, 1, 1}});
  builder.quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, builder.material(cut));
  builder.quad({0, 0, 3}, {1, 0, 0}, {0, 1, 0}, builder.material(patterned));
  const Elements made = elementsOf(builder.scene, {{"elements", 512}});
  double holed = 0.0;
  const std::vector<float> albedo = made.made.albedo->downloadFloats();
  for (std::uint32_t leaf = 0; leaf < made.tree().leafCount; ++leaf)
    if (made.tree().objectOfNode[leaf] == 0) holed += static_cast<double>(made.state().area[leaf]);
  CHECK(holed == Approx(0.5).epsilon(0.05));
  for (const ElementTree::Segment& segment : made.tree().segments)
    if (segment.object == 1) CHECK(albedo[4 * segment.root] == Approx(0.5).epsilon(0.02));
}

TEST_CASE("a mirrored body keeps its front sides") {
  Scene scene = boxAndSphere();
  for (Object& object : scene.objects)
    place(scene, object, glm::scale(glm::dmat4(1.0), glm::dvec3(-1, 1, 1)));
  const Elements texels = elementsOf(scene, {{"elements", 400}});
  for (std::uint32_t leaf = 0; leaf < texels.tree().leafCount; ++leaf) {
    const std::uint32_t object = texels.tree().objectOfNode[leaf];
    if (object >= 6) continue;  // a wall of the box
    glm::vec3 normal = scene.normals[scene.objects[object].firstVertex];
    normal.x = -normal.x;
    CHECK(glm::dot(texels.state().normal[leaf], normal) > 0.999f);
  }
}
