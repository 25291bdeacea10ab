// Points spread over surfaces: evenly, on the sides that count, moving with what they lie on, and found
// again.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <random>

#include "../../techniques/virtual_area_lights/points/surface_points.h"
#include "lumivox/scene/models.h"
#include "support/placed.h"
#include "support/scene_builder.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::virtual_area_lights;

namespace {

Scene floorScene() {
  SceneBuilder builder;
  builder.quad({-1, 0, -2}, {0, 0, 4}, {2, 0, 0}, builder.lambert(0.5f));
  return builder.scene;
}

/// One object, closed: the six sides of a box with its front sides outwards.
Scene boxScene(const glm::vec3& size) {
  SceneBuilder builder;
  std::vector<glm::vec3> corners;
  for (int axis = 0; axis < 3; ++axis)
    for (const bool upper : {false, true}) {
      glm::vec3 corner(0.0f), edge1(0.0f), edge2(0.0f);
      if (upper) corner[axis] = size[axis];
      edge1[(axis + 1) % 3] = size[(axis + 1) % 3];
      edge2[(axis + 2) % 3] = size[(axis + 2) % 3];
      if (!upper) std::swap(edge1, edge2);
      for (const glm::vec3& c :
           {corner, corner + edge1, corner + edge1 + edge2, corner, corner + edge1 + edge2, corner + edge2})
        corners.push_back(c);
    }
  builder.mesh(corners, builder.lambert(0.5f));
  return builder.scene;
}

struct Spread {
  SurfacePointSet set;
  SurfacePointState state;
  std::size_t size() const { return set.points.size(); }
};
Spread spread(const Scene& scene, int points, double time = 0.0) {
  Spread made{spreadSurfacePoints(scene, {.points = points}), {}};
  made.state = stateOf(made.set, scene, snapshotOf(scene, time));
  return made;
}

/// Smallest distance between points whose normals are alike.
double smallestGap(const SurfacePointState& state) {
  double gap = INFINITY;
  for (std::size_t i = 0; i < state.position.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (glm::dot(state.normal[i], state.normal[j]) > 0.5f)
        gap = std::min(gap, static_cast<double>(glm::distance(state.position[i], state.position[j])));
  return gap;
}

double sum(const std::vector<float>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

/// Random places on triangles that stay in their object, by area.
struct Place {
  glm::vec3 position, normal;
};
std::vector<Place> randomPlaces(const Scene& scene, const SceneSnapshot& snapshot, int count) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  std::vector<std::array<glm::vec3, 3>> triangles;
  std::vector<double> areas;
  for (std::size_t o = 0; o < scene.objects.size(); ++o)
    for (const Part& part : scene.objects[o].parts)
      for (std::uint32_t i = 0; i < part.indexCount; i += 3) {
        auto& corners = triangles.emplace_back();
        for (std::uint32_t k = 0; k < 3; ++k)
          corners[k] = glm::vec3(snapshot.objects[o].toWorld *
                                 glm::vec4(scene.positions[scene.indices[part.firstIndex + i + k]], 1.0f));
        areas.push_back(
            static_cast<double>(glm::length(glm::cross(corners[1] - corners[0], corners[2] - corners[0]))));
      }
  std::discrete_distribution<std::size_t> which(areas.begin(), areas.end());
  std::vector<Place> places;
  for (int i = 0; i < count; ++i) {
    const auto& [a, b, c] = triangles[which(random)];
    const float root = std::sqrt(unit(random)), third = root * unit(random);
    places.push_back(
        {a + (root - third) * (b - a) + third * (c - a), glm::normalize(glm::cross(b - a, c - a))});
  }
  return places;
}

/// The nearest points on a side among `numbers`, the nearest first.
std::vector<std::uint32_t> nearest(const SurfacePointState& state, const Place& place,
                                   std::vector<std::uint32_t> numbers, std::size_t count) {
  std::erase_if(numbers,
                [&](std::uint32_t i) { return glm::dot(state.normal[i], place.normal) < kOtherSideCosine; });
  std::sort(numbers.begin(), numbers.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::pair(glm::distance(state.position[a], place.position), a) <
           std::pair(glm::distance(state.position[b], place.position), b);
  });
  numbers.resize(std::min(numbers.size(), count));
  return numbers;
}

std::vector<std::uint32_t> listed(const SurfacePointGrid& grid, const glm::vec3& position) {
  const GridPlacement& placement = grid.placement;
  const glm::ivec3 cell = glm::clamp(glm::ivec3(glm::floor((position - placement.low) / placement.voxelSize)),
                                     glm::ivec3(0), placement.resolution - 1);
  const auto index =
      static_cast<std::size_t>(cell.x + placement.resolution.x * (cell.y + placement.resolution.y * cell.z));
  return {grid.points.begin() + grid.first[index], grid.points.begin() + grid.first[index + 1]};
}

}  // namespace

TEST_CASE("both sides of an open surface have points, back behind front, whose areas sum to both sides") {
  const Scene scene = floorScene();
  const Spread points = spread(scene, 400);
  REQUIRE(points.size() == 400);
  CHECK(points.set.area == Approx(16.0));
  CHECK(sum(points.state.area) == Approx(16.0));
  for (std::size_t i = 0; i < points.size(); i += 2) {
    REQUIRE_FALSE(points.set.points[i].back);
    REQUIRE(points.set.points[i + 1].back);
    REQUIRE(points.state.position[i] == points.state.position[i + 1]);
    REQUIRE(points.state.normal[i] == glm::vec3(0, 1, 0));
    REQUIRE(points.state.normal[i + 1] == glm::vec3(0, -1, 0));
    REQUIRE(points.state.area[i] == points.state.area[i + 1]);
  }
}

TEST_CASE("a closed surface has points on its front alone, as many to the square metre on each side of it") {
  const Spread points = spread(boxScene({1, 2, 3}), 2200);
  REQUIRE(points.size() == 2200);
  CHECK(sum(points.state.area) == Approx(22.0));
  std::map<std::string, int> counts;
  for (std::size_t i = 0; i < points.size(); ++i) {
    REQUIRE_FALSE(points.set.points[i].back);
    const glm::vec3& normal = points.state.normal[i];
    // Outwards: from the middle.
    REQUIRE(glm::dot(points.state.position[i] - glm::vec3(0.0f), normal) > 0.0f);
    ++counts[normal.x != 0.0f ? "x" : normal.y != 0.0f ? "y" : "z"];
  }
  CHECK(counts["x"] == Approx(1200).epsilon(0.04));
  CHECK(counts["y"] == Approx(600).epsilon(0.04));
  CHECK(counts["z"] == Approx(400).epsilon(0.04));
}

TEST_CASE("points lie apart as blue noise does: no two nearer than six tenths of the densest packing") {
  // Discs at the corners of a net of equal triangles: each point stands for sqrt(3)/2 of a squared distance.
  const Spread points = spread(floorScene(), 2000);
  const double packed = std::sqrt(8.0 / 1000.0 * 2.0 / std::sqrt(3.0));
  CHECK(smallestGap(points.state) > 0.6 * packed);
  // Without a place that is far from all of them.
  CHECK(*std::max_element(points.state.radius.begin(), points.state.radius.end()) < packed);
  // Random points of that number: some are a fiftieth of that apart.
  std::vector<Place> places = randomPlaces(floorScene(), snapshotOf(floorScene(), 0.0), 1000);
  SurfacePointState random;
  for (const Place& place : places)
    random.position.push_back(place.position), random.normal.push_back(place.normal);
  CHECK(smallestGap(random) < 0.05 * packed);
}

TEST_CASE("the two sides of a thin closed plate do not thin each other") {
  const Spread thin = spread(boxScene({1, 1, 0.002f}), 1000), thick = spread(boxScene({1, 1, 1}), 3000);
  int front = 0;
  for (const glm::vec3& normal : thin.state.normal) front += normal.z > 0.5f ? 1 : 0;
  CHECK(front == Approx(500).epsilon(0.05));
  const double packed = std::sqrt(2.0 / 1000.0 * 2.0 / std::sqrt(3.0));
  CHECK(smallestGap(thin.state) > 0.6 * packed);
  CHECK(smallestGap(thick.state) > 0.6 * packed);
}

TEST_CASE("triangles that face both ways have points on both sides, though they close") {
  Scene scene = boxScene({1, 1, 1});
  std::swap(scene.indices[0], scene.indices[1]);
  const Spread points = spread(scene, 240);
  CHECK(sum(points.state.area) == Approx(12.0));
}

TEST_CASE("the holes of masks have no points, and what is left as many as asked for") {
  SceneBuilder builder;
  SurfaceTexture mask;
  mask.width = mask.height = 64;
  mask.mask = true;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) mask.values.push_back(x < 16 ? 1.0f : 0.0f);
  builder.scene.textures.push_back(mask);
  Material material;
  material.maskTexture = 0;
  builder.quad({0, 0, 0}, {1, 0, 0}, {0, 0, 1}, builder.material(material));
  const Spread points = spread(builder.scene, 1000);
  CHECK(points.size() == 1000);
  CHECK(points.set.area == Approx(0.5).epsilon(0.01));
  for (const glm::vec3& position : points.state.position) REQUIRE(position.x < 0.255f);
  const double packed = std::sqrt(0.25 / 500.0 * 2.0 / std::sqrt(3.0));
  CHECK(smallestGap(points.state) > 0.6 * packed);
}

TEST_CASE(
    "a surface that is all hole, has no area or is not there has no points, and a grid of one empty cell") {
  SceneBuilder builder;
  builder.mesh({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, builder.lambert(0.5f));
  const Spread points = spread(builder.scene, 100);
  CHECK(points.size() == 0);
  CHECK(points.set.spacing() == 0.0);
  const SurfacePointGrid grid = gridOf(points.set, points.state);
  CHECK(grid.placement.voxelCount() == 1);
  CHECK(grid.first == std::vector<std::uint32_t>{0, 0});
  CHECK(spread(SceneBuilder().scene, 100).size() == 0);
}

TEST_CASE(
    "objects of one motion are one model, what deforms is one of its own, and all that stands still is 0") {
  SceneBuilder builder;
  const int white = builder.lambert(0.5f);
  RigidMotion turn, other;
  turn.angularSpeed = 1.0;
  other.velocity = {1, 0, 0};
  for (int i = 0; i < 6; ++i) builder.quad({3 * i, 0, 0}, {0, 0, 1}, {1, 0, 0}, white);
  builder.scene.objects[1].motion = turn;
  builder.scene.objects[2].motion = other;
  builder.scene.objects[4].motion = turn;
  builder.scene.objects[5].motion = turn;
  VertexSequence sequence;
  sequence.positions.assign(2, {builder.scene.positions.end() - 4, builder.scene.positions.end()});
  sequence.normals.assign(2, {builder.scene.normals.end() - 4, builder.scene.normals.end()});
  builder.scene.objects[5].sequence = sequence;
  CHECK(modelsOf(builder.scene) == std::vector<std::uint32_t>{0, 1, 2, 0, 1, 3});
  // As dense on each: two of the six are still, two turn.
  const Spread points = spread(builder.scene, 600);
  std::map<std::uint32_t, int> counts;
  for (const SurfacePoint& point : points.set.points) ++counts[point.model];
  CHECK(counts == std::map<std::uint32_t, int>{{0, 200}, {1, 200}, {2, 100}, {3, 100}});
  // And one place at least, where there are fewer points than models.
  CHECK(spread(builder.scene, 1).size() == 8);
}

TEST_CASE("points move with what they lie on, and a mirrored surface keeps its front") {
  Scene scene = boxScene({1, 1, 1});
  RigidMotion motion;
  motion.axis = {0, 1, 0};
  motion.angularSpeed = 0.5 * std::numbers::pi;
  motion.velocity = {0, 2, 0};
  scene.objects[0].motion = motion;
  const Spread rest = spread(scene, 300), moved = spread(scene, 300, 1.0);
  CHECK(rest.set.points == moved.set.points);
  const glm::vec3 shift(snapshotOf(scene, 0.0).origin - snapshotOf(scene, 1.0).origin);
  for (std::size_t i = 0; i < rest.size(); ++i) {
    // A quarter turn about y: x to -z, z to x.
    const glm::vec3 from = rest.state.position[i] + glm::vec3(snapshotOf(scene, 0.0).origin);
    const glm::vec3 expected =
        glm::vec3(from.z, from.y + 2.0f, -from.x) - glm::vec3(snapshotOf(scene, 1.0).origin);
    REQUIRE(glm::distance(moved.state.position[i], expected) < 1e-5f);
    const glm::vec3& normal = rest.state.normal[i];
    REQUIRE(glm::distance(moved.state.normal[i], glm::vec3(normal.z, normal.y, -normal.x)) < 1e-5f);
    REQUIRE(moved.state.radius[i] == rest.state.radius[i]);
  }
  scene.objects[0].motion.reset();
  glm::dmat4 mirror = scene.objects[0].placement;
  mirror[0][0] = -1.0;
  place(scene, scene.objects[0], mirror);
  const Spread mirrored = spread(scene, 300);
  const glm::vec3 middle(snapshotOf(scene, 0.0).origin);
  for (std::size_t i = 0; i < mirrored.size(); ++i)
    REQUIRE(glm::dot(mirrored.state.position[i] + middle - glm::vec3(-0.5, 0.5, 0.5),
                     mirrored.state.normal[i]) > 0.0f);
}

TEST_CASE(
    "points follow a surface that is pulled to twice its width, and are nothing on one that shrinks to a point") {
  Scene scene = floorScene();
  VertexSequence sequence;
  sequence.framesPerSecond = 1.0;
  sequence.loop = false;
  for (const float width : {1.0f, 2.0f, 0.0f}) {
    std::vector<glm::vec3> positions;
    for (const glm::vec3& position : scene.positions) positions.push_back(position * width);
    sequence.positions.push_back(positions);
    sequence.normals.push_back(scene.normals);
  }
  scene.objects[0].sequence = sequence;
  const Spread rest = spread(scene, 200), wide = spread(scene, 200, 1.0), gone = spread(scene, 200, 2.0);
  CHECK(sum(wide.state.area) == Approx(64.0));
  for (std::size_t i = 0; i < rest.size(); ++i) {
    REQUIRE(glm::distance(wide.state.position[i], 2.0f * rest.state.position[i]) < 1e-5f);
    REQUIRE(wide.state.radius[i] == Approx(2.0f * rest.state.radius[i]));
    REQUIRE(gone.state.normal[i] == glm::vec3(0.0f));
    REQUIRE(gone.state.area[i] == 0.0f);
    REQUIRE(gone.state.radius[i] == 0.0f);
  }
  CHECK(gridOf(gone.set, gone.state).points.empty());
}

TEST_CASE("from any place the grid finds the eight nearest points on its side") {
  SceneBuilder builder = SceneBuilder();
  builder.scene = boxScene({1, 1, 0.01f});
  const int white = builder.lambert(0.5f);
  builder.quad({-1, -1, -1}, {0, 0, 3}, {3, 0, 0}, white);
  builder.quad({-1, -1, -1}, {3, 0, 0}, {0, 3, 0}, white);
  const Scene& scene = builder.scene;
  for (const int count : {40, 1000}) {
    const Spread points = spread(scene, count);
    const SurfacePointGrid grid = gridOf(points.set, points.state);
    // Beyond the eighth on a plane, twice over.
    CHECK(points.set.farthest > 2.0 * points.set.spacing() * std::sqrt(8.0 * std::numbers::inv_pi));
    std::vector<std::uint32_t> all(points.size());
    std::iota(all.begin(), all.end(), 0u);
    int missed = 0;
    for (const Place& place : randomPlaces(scene, snapshotOf(scene, 0.0), 4000)) {
      std::vector<std::uint32_t> wanted = nearest(points.state, place, all, 8);
      std::erase_if(wanted, [&](std::uint32_t i) {
        return i != wanted.front() && glm::distance(points.state.position[i], place.position) >
                                          static_cast<float>(points.set.farthest);
      });
      missed += nearest(points.state, place, listed(grid, place.position), wanted.size()) != wanted ? 1 : 0;
    }
    CHECK(missed <= 4);  // of 4000: beside a place that no candidate is near
  }
}

TEST_CASE(
    "the grid finds the eight nearest points where a model is pulled to three times its length, or to a third") {
  int missed = 0;
  // A cube, and a plate whose triangles are long across the pull, so that their longest sides hardly grow.
  for (const glm::vec3& size : {glm::vec3(1.0f), glm::vec3(0.3f, 2.0f, 1.0f)})
    for (const float pull : {3.0f, 1.0f / 3.0f}) {
      Scene scene = boxScene(size);
      const Scene pulled = boxScene(size * glm::vec3(pull, 1, 1));
      VertexSequence sequence;
      sequence.framesPerSecond = 1.0;
      sequence.loop = false;
      sequence.positions = {scene.positions, pulled.positions};
      sequence.normals = {scene.normals, pulled.normals};
      scene.objects[0].sequence = sequence;
      const Spread points = spread(scene, 600, 1.0);
      const SurfacePointGrid grid = gridOf(points.set, points.state);
      std::vector<std::uint32_t> all(points.size());
      std::iota(all.begin(), all.end(), 0u);
      const SceneSnapshot snapshot = snapshotOf(pulled, 0.0);
      const glm::vec3 shift(snapshot.origin - snapshotOf(scene, 1.0).origin);
      for (Place place : randomPlaces(pulled, snapshot, 500)) {
        place.position += shift;
        const std::vector<std::uint32_t> candidates = listed(grid, place.position);
        if (nearest(points.state, place, candidates, 8) != nearest(points.state, place, all, 8)) ++missed;
      }
    }
  CHECK(missed <= 5);  // of 2000: beside an edge of a side that the pull leaves as it is
}

TEST_CASE("the only point of a long strip is found from all of it, however far beyond the reach of others") {
  SceneBuilder builder;
  const int white = builder.lambert(0.5f);
  builder.quad({0, 0, 0}, {0, 0, 1}, {1, 0, 0}, white);
  builder.quad({-5, 1, 0}, {0, 0, 1e-4f}, {10, 0, 0}, white);
  builder.scene.objects[1].motion = RigidMotion{};
  const Spread points = spread(builder.scene, 200);
  const std::uint32_t strip = points.set.points.back().model;
  REQUIRE(strip == 1);
  REQUIRE(points.set.farthest < 1.0);
  const SurfacePointGrid grid = gridOf(points.set, points.state);
  const glm::vec3 origin(snapshotOf(builder.scene, 0.0).origin);
  for (float x = -5.0f; x <= 5.0f; x += 0.25f) {
    CAPTURE(x);
    const std::vector<std::uint32_t> here = listed(grid, glm::vec3(x, 1, 5e-5f) - origin);
    CHECK(std::any_of(here.begin(), here.end(),
                      [&](std::uint32_t point) { return points.set.points[point].model == strip; }));
  }
}

TEST_CASE("a grid has no longer lists where two small objects are far from each other") {
  SceneBuilder builder;
  const int white = builder.lambert(0.5f);
  builder.quad({0, 0, 0}, {0, 0, 1}, {1, 0, 0}, white);
  builder.quad({1e5f, 0, 0}, {0, 0, 1}, {1, 0, 0}, white);
  const Spread points = spread(builder.scene, 100);
  REQUIRE(points.size() == 100);
  const SurfacePointGrid grid = gridOf(points.set, points.state);
  CHECK(grid.points.size() <= SurfacePointGrid::mostEntries(points.size()));
  CHECK(grid.placement.voxelCount() < SurfacePointGrid::mostCells(points.size()));
  std::vector<std::uint32_t> here = listed(grid, points.state.position.front());
  CHECK(here.size() <= 50);
}

TEST_CASE("points are those of a scene that lies a thousand kilometres away") {
  const Scene near = boxScene({1, 1, 1});
  Scene far = near;
  far.objects[0].placement[3] = glm::dvec4(1e6, 2e6, 0, 1);
  CHECK(spread(near, 200).set.points == spread(far, 200).set.points);
}
