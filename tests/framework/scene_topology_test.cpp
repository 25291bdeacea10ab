// Which surfaces are closed, and what volume they enclose.
#include "lumivox/scene/topology.h"
#include "support/scene_builder.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

/// All of the scene's objects as one object.
Object joined(const Scene& scene) {
  Object whole;
  whole.vertexCount = static_cast<std::uint32_t>(scene.positions.size());
  for (const Object& object : scene.objects)
    whole.parts.insert(whole.parts.end(), object.parts.begin(), object.parts.end());
  return whole;
}

std::vector<SurfaceComponent> componentsOf(const Scene& scene) {
  return surfaceComponents(weld(scene, joined(scene)));
}

}  // namespace

TEST_CASE("a box of six quads with split vertices is one closed surface of its volume") {
  SceneBuilder builder;
  builder.box({-1, -2, 3}, {1, 1, 7}, builder.lambert(0.5f), false);
  const WeldedObject welded = weld(builder.scene, joined(builder.scene));
  CHECK(welded.places.size() == 8);
  CHECK(welded.triangleCount() == 12);
  const auto components = surfaceComponents(welded);
  REQUIRE(components.size() == 1);
  CHECK(components[0].closed());
  CHECK(components[0].volume == Approx(2.0 * 3.0 * 4.0));
}

TEST_CASE("a box that faces inwards encloses the same volume with the other sign") {
  SceneBuilder builder;
  builder.box({1e4f, 0, 0}, {1e4f + 1.0f, 1, 1}, builder.lambert(0.5f), true);
  const auto components = componentsOf(builder.scene);
  REQUIRE(components.size() == 1);
  CHECK(components[0].closed());
  CHECK(components[0].volume == Approx(-1.0));
}

TEST_CASE("a box without its lid is open along the four edges of the lid") {
  SceneBuilder builder;
  builder.box({0, 0, 0}, {1, 1, 1}, builder.lambert(0.5f), false);
  builder.scene.objects.pop_back();
  const auto components = componentsOf(builder.scene);
  REQUIRE(components.size() == 1);
  CHECK(components[0].openEdges == 4);
}

TEST_CASE("a lid that is there twice closes the box once, and a lid and its reverse cancel") {
  SceneBuilder builder;
  builder.box({0, 0, 0}, {1, 1, 1}, builder.lambert(0.5f), false);
  Scene twice = builder.scene;
  twice.objects.push_back(twice.objects.back());
  const auto closed = componentsOf(twice);
  REQUIRE(closed.size() == 1);
  CHECK(closed[0].closed());
  CHECK(closed[0].volume == Approx(1.0));

  SceneBuilder sheet;
  const int grey = sheet.lambert(0.5f);
  sheet.quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, grey);
  sheet.quad({1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, grey);
  // The second quad is cut along the other diagonal of the same square.
  const auto flat = componentsOf(sheet.scene);
  REQUIRE(flat.size() == 1);
  CHECK(flat[0].volume == Approx(0.0).margin(1e-12));
}

TEST_CASE("boxes apart are components of their own, boxes that share an edge are one") {
  SceneBuilder builder;
  const int grey = builder.lambert(0.5f);
  builder.box({0, 0, 0}, {1, 1, 1}, grey, false);
  builder.box({2, 0, 0}, {3, 1, 1}, grey, false);
  CHECK(componentsOf(builder.scene).size() == 2);
  builder.box({1, 1, 0}, {2, 2, 1}, grey, false);  // touches both along an edge: four triangles there
  const auto components = componentsOf(builder.scene);
  REQUIRE(components.size() == 1);
  CHECK(components[0].closed());
  CHECK(components[0].volume == Approx(3.0));
}

TEST_CASE("triangles without area keep a surface closed, and nothing has no components") {
  SceneBuilder builder;
  builder.box({0, 0, 0}, {1, 1, 1}, builder.lambert(0.5f), false);
  Scene scene = builder.scene;
  Object& last = scene.objects.back();
  const std::uint32_t a = scene.indices[last.parts.front().firstIndex],
                      b = scene.indices[last.parts.front().firstIndex + 1];
  scene.indices.insert(scene.indices.end(), {a, a, b, a, a, a});
  last.parts.front().indexCount += 6;
  for (const SurfaceComponent& component : componentsOf(scene)) CHECK(component.closed());
  CHECK(componentsOf(SceneBuilder().scene).empty());
}
