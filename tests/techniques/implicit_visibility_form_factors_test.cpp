// Form factors over links against closed forms, and what elements see against rays.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "support/closed_room.h"
#include "support/form_factors.h"
#include "support/surface_elements.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

/// The share of what object `from` sends out from its front that arrives at object `to`.
double formFactor(const LinkedScene& scene, std::uint32_t from, std::uint32_t to) {
  const BinWeights weights(scene.links);
  const ElementTree& tree = scene.tree();
  double sum = 0.0, area = 0.0;
  for (std::uint32_t leaf = 0; leaf < tree.leafCount; ++leaf) {
    if (tree.objectOfNode[leaf] != from) continue;
    const glm::vec3 normal = scene.state().normal[leaf];
    double seen = 0.0;
    for (const ElementLink& link : scene.seenBy(leaf))
      if (tree.objectOfNode[link.node] == to) seen += std::max(weights(normal, link.bin()), 0.0);
    const double leafArea = static_cast<double>(scene.state().area[leaf]);
    sum += leafArea * seen * weights.scale(normal) / kPi;
    area += leafArea;
  }
  return sum / area;
}

struct Arrangement {
  std::string name;
  Scene scene;
  double factor;
};

std::vector<glm::vec3> discCorners(float height, bool up) {
  constexpr int kSectors = 64;
  std::vector<glm::vec3> corners;
  const auto at = [&](int i) {
    const double angle = 2.0 * kPi * i / kSectors;
    return glm::vec3(std::cos(angle), height, -std::sin(angle));
  };
  for (int i = 0; i < kSectors; ++i) {
    const glm::vec3 middle(0, height, 0), a = at(i), b = at(i + 1);
    if (up)
      corners.insert(corners.end(), {middle, a, b});
    else
      corners.insert(corners.end(), {middle, b, a});
  }
  return corners;
}

/// Unit squares and discs whose form factors are known (Howell's catalogue C-11, C-14, C-41).
std::vector<Arrangement> arrangements() {
  SceneBuilder facing, upright, screened, discs;
  const int grey = facing.lambert(0.5f);
  for (SceneBuilder* builder : {&upright, &screened, &discs}) builder->lambert(0.5f);
  for (SceneBuilder* builder : {&facing, &upright, &screened})
    builder->quad({0, 0, 0}, {0, 0, 1}, {1, 0, 0}, grey);
  for (SceneBuilder* builder : {&facing, &screened}) builder->quad({0, 1, 0}, {1, 0, 0}, {0, 0, 1}, grey);
  upright.quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, grey);
  // Half a centimetre below the upper square it hides the half of it.
  screened.quad({0.5f, 0.995f, 0}, {0.5f, 0, 0}, {0, 0, 1}, grey);
  discs.mesh(discCorners(0.0f, true), grey);
  discs.mesh(discCorners(1.0f, false), grey);
  const double facingFactor = 0.19982;
  return {{"facing squares", facing.scene, facingFactor},
          {"adjoining squares", upright.scene, 0.20004},
          {"a square behind a screen that hides half", screened.scene, 0.5 * facingFactor},
          {"coaxial discs", discs.scene, 0.5 * (3.0 - std::sqrt(5.0))}};
}

Scene turned(Scene scene) {
  const glm::dmat4 turn = glm::mat4_cast(glm::angleAxis(1.1, glm::normalize(glm::dvec3(1, 2, -0.7))));
  for (Object& object : scene.objects) object.placement = turn * object.placement;
  return scene;
}

LinkedScene linkedWith(const Scene& scene, int side, int bins, const std::string& fill) {
  const double leaves = static_cast<double>(side * side) * static_cast<double>(scene.objects.size());
  return linked(
      scene, {{{"elements", leaves}, {"share", 0}}, {{"bins", static_cast<double>(bins)}}, {{"fill", fill}}});
}

/// `sizes`: elements along the side of a square, and bins.
void checkFormFactors(const std::vector<std::pair<int, int>>& sizes) {
  for (const Arrangement& arrangement : arrangements())
    for (const bool isTurned : {false, true})
      for (const auto& [side, bins] : sizes) {
        const Scene scene = isTurned ? turned(arrangement.scene) : arrangement.scene;
        const double factor = formFactor(linkedWith(scene, side, bins, "centre"), 0, 1);
        CAPTURE(arrangement.name, isTurned, side, bins, factor / arrangement.factor);
        CHECK(factor == Approx(arrangement.factor).epsilon(0.06));
      }
}

/// A fan of triangles 2 m up that faces down, of a convex polygon in x and z.
std::vector<glm::vec3> lampCorners(const std::vector<glm::dvec2>& polygon) {
  std::vector<glm::vec3> result;
  const auto at = [&](std::size_t i) { return glm::vec3(polygon[i].x, 2.0, polygon[i].y); };
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) result.insert(result.end(), {at(0), at(i), at(i + 1)});
  return result;
}

/// Two quads that share the middle two of six places, facing down.
std::vector<glm::vec3> lampSheet(const std::vector<glm::vec3>& places) {
  std::vector<glm::vec3> result;
  for (const std::size_t first : {0u, 2u})
    for (const std::size_t corner : {0u, 2u, 3u, 0u, 3u, 1u}) result.push_back(places[first + corner]);
  return result;
}

/// A floor of 4 m, object 0, and a lamp over it, object 1.
Scene floorAndLamp(const std::vector<glm::vec3>& lamp) {
  SceneBuilder builder;
  const int grey = builder.lambert(0.5f);
  builder.quad({-2, 0, -2}, {0, 0, 4}, {4, 0, 0}, grey);
  builder.mesh(lamp, grey);
  return builder.scene;
}

/// Elements of one size on all objects.
LinkedScene linkedBySize(const Scene& scene, double elements, double time = 0.0) {
  return linked(scene, {{{"elements", elements}, {"share", 1}}, {{"bins", 64}}, {}}, time);
}

int leavesOf(const LinkedScene& scene, std::uint32_t object) {
  const std::vector<std::uint32_t>& objects = scene.tree().objectOfNode;
  return static_cast<int>(std::count(objects.begin(), objects.begin() + scene.tree().leafCount, object));
}

/// Triangles of an object, relative to the snapshot's origin.
std::vector<glm::dvec3> placedAt(const Scene& scene, double time) {
  const SceneSnapshot snapshot = snapshotOf(scene, time);
  const Object& lamp = scene.objects[1];
  std::vector<glm::dvec3> result;
  for (const Part& part : lamp.parts)
    for (std::uint32_t i = part.firstIndex; i < part.firstIndex + part.indexCount; ++i) {
      const std::uint32_t vertex = scene.indices[i];
      const ObjectState& state = snapshot.objects[1];
      const glm::vec3 local =
          state.positions.empty() ? scene.positions[vertex] : state.positions[vertex - lamp.firstVertex];
      result.emplace_back(state.toWorld * glm::vec4(local, 1.0f));
    }
  return result;
}

/// What the floor sees of the lamp, over what it should.
double overLambert(const LinkedScene& scene, const std::vector<glm::dvec3>& lamp) {
  const BinWeights weights(scene.links);
  double seen = 0.0, exact = 0.0;
  for (std::uint32_t leaf = 0; leaf < scene.tree().leafCount; ++leaf) {
    if (scene.tree().objectOfNode[leaf] != 0) continue;
    const glm::vec3 normal = scene.state().normal[leaf];
    for (const ElementLink& link : scene.seenBy(leaf))
      if (scene.tree().objectOfNode[link.node] == 1)
        seen += std::max(weights(normal, link.bin()), 0.0) * weights.scale(normal) / kPi;
    for (std::size_t t = 0; t < lamp.size(); t += 3)
      exact += polygonFormFactor(glm::dvec3(scene.state().position[leaf]), glm::dvec3(normal),
                                 {lamp[t], lamp[t + 1], lamp[t + 2]});
  }
  return seen / exact;
}

/// The first triangle that a ray meets, in double precision.
struct Hit {
  double distance = std::numeric_limits<double>::infinity();
  std::uint32_t triangle = 0;
};
Hit firstHit(const Scene& scene, const glm::dvec3& origin, const glm::dvec3& direction, double from) {
  Hit hit;
  for (std::uint32_t t = 0; t < scene.triangleCount(); ++t) {
    const auto at = [&](std::uint32_t k) { return glm::dvec3(scene.positions[scene.indices[3 * t + k]]); };
    const glm::dvec3 e1 = at(1) - at(0), e2 = at(2) - at(0), p = glm::cross(direction, e2);
    const double determinant = glm::dot(e1, p);
    if (std::abs(determinant) < 1e-14) continue;
    const glm::dvec3 s = origin - at(0), q = glm::cross(s, e1);
    const double u = glm::dot(s, p) / determinant, v = glm::dot(direction, q) / determinant,
                 distance = glm::dot(e2, q) / determinant;
    if (u < 0.0 || v < 0.0 || u + v > 1.0 || distance <= from || distance >= hit.distance) continue;
    hit = {distance, t};
  }
  return hit;
}

}  // namespace

TEST_CASE("form factors hold in closed form, whatever the sizes of elements and bins, aligned and turned") {
  checkFormFactors({{12, 8}, {24, 12}, {12, 32}, {48, 8}});
}

TEST_CASE(
    "a lamp of 1, 4 or 9 elements over a floor has Lambert's form factor within 2 %, aligned and turned") {
  for (const int side : {1, 2, 3})
    for (const bool isTurned : {false, true}) {
      const Scene flat = floorAndLamp(lampCorners({{-0.25, 0}, {0.25, 0}, {0.25, 0.5}, {-0.25, 0.5}})),
                  scene = isTurned ? turned(flat) : flat;
      const LinkedScene made = linkedBySize(scene, 64.0 * side * side);
      CAPTURE(side, isTurned);
      REQUIRE(leavesOf(made, 1) == side * side);
      CHECK(overLambert(made, placedAt(scene, 0.0)) == Approx(1.0).epsilon(0.02));
    }
}

TEST_CASE("a single element has the form factor of its shape within 2 %, whatever that is") {
  struct Shape {
    const char* name;
    std::vector<glm::dvec2> outline;
  };
  std::vector<glm::dvec2> circle;
  for (int i = 0; i < 64; ++i)
    circle.push_back(0.3 * glm::dvec2(std::cos(2.0 * kPi * i / 64), std::sin(2.0 * kPi * i / 64)));
  for (const Shape& shape :
       {Shape{"triangle", {{-0.3, 0}, {0.4, 0.1}, {-0.1, 0.6}}},
        // Slanted, since lines of bins would meet one that lies along them all or not at all.
        Shape{"strip", {{-0.8, -0.2}, {0.92, 0.33}, {0.89, 0.43}, {-0.83, -0.1}}},
        Shape{"trapezoid", {{-0.5, 0}, {0.5, 0}, {0.1, 0.4}, {-0.1, 0.4}}},
        Shape{"disc of 64 corners", circle}})
    for (const bool isTurned : {false, true}) {
      const Scene flat = floorAndLamp(lampCorners(shape.outline)), scene = isTurned ? turned(flat) : flat;
      const LinkedScene made = linkedBySize(scene, 16.0);
      CAPTURE(shape.name, isTurned);
      REQUIRE(leavesOf(made, 1) == 1);
      CHECK(overLambert(made, placedAt(scene, 0.0)) == Approx(1.0).epsilon(0.02));
    }
}

TEST_CASE(
    "a piece that bends counts as its surface does, and no more than its bend adds, in any number of elements") {
  // A lamp of half a metre whose middle line hangs lower or higher, by angles between its halves in degrees.
  for (const double angle : {1.0, -1.0, 10.0, -30.0})
    for (const int side : {1, 2, 3}) {
      const auto drop = static_cast<float>(0.25 * std::tan(0.5 * angle * kPi / 180.0));
      std::vector<glm::vec3> places;
      for (const float x : {-0.25f, 0.0f, 0.25f})
        for (const float z : {0.0f, 0.5f}) places.emplace_back(x, 2.0f - (x == 0.0f ? drop : 0.0f), z);
      const Scene scene = floorAndLamp(lampSheet(places));
      const LinkedScene made = linkedBySize(scene, 64.0 * side * side);
      const double ratio = overLambert(made, placedAt(scene, 0.0));
      CAPTURE(angle, side, leavesOf(made, 1), ratio);
      // An outline is larger by the sine of what normals turn away from their mean, and a disc by pi/2.
      const double larger = 1.0 + std::sin(0.5 * std::abs(angle) * kPi / 180.0);
      CHECK(ratio > 0.97);
      CHECK(ratio < 1.02 * std::min(larger * larger, 0.5 * kPi));
    }
}

TEST_CASE("a single element that turns, travels, stretches and shears takes its form factor along") {
  Scene scene = floorAndLamp(lampCorners({{-0.25, 0}, {0.25, 0}, {0.25, 0.5}, {-0.25, 0.5}}));
  SECTION("of a body") {
    RigidMotion motion;
    motion.axis = {0, 1, 0};
    motion.angularSpeed = 0.8;
    motion.velocity = {0.3, -0.4, 0.2};
    scene.objects[1].motion = motion;
  }
  SECTION("of a sheet that deforms") {
    const Object& lamp = scene.objects[1];
    VertexSequence sequence;
    sequence.framesPerSecond = 1.0;
    const auto* first = &scene.positions[lamp.firstVertex];
    sequence.positions.assign(2, std::vector<glm::vec3>(first, first + lamp.vertexCount));
    for (glm::vec3& place : sequence.positions[1])
      place = glm::vec3(2.0f * place.x + 0.7f * place.z, place.y + 0.3f * place.x, 0.5f * place.z);
    sequence.normals.assign(2, std::vector<glm::vec3>(lamp.vertexCount, glm::vec3(0, -1, 0)));
    scene.objects[1].sequence = sequence;
  }
  const LinkedScene made = linkedBySize(scene, 64.0, 1.0);
  REQUIRE(leavesOf(made, 1) == 1);
  CHECK(overLambert(made, placedAt(scene, 1.0)) == Approx(1.0).epsilon(0.02));
}

TEST_CASE("form factors hold in closed form for every size of elements and bins", "[.]") {
  for (const int side : {12, 24, 48})
    for (const int bins : {8, 12, 16, 24, 32}) checkFormFactors({{side, bins}});
}

TEST_CASE(
    "with one bin for each element, as published, form factors depend on the sizes of elements and bins") {
  double least = 10.0, most = 0.0;
  for (const Arrangement& arrangement : arrangements())
    for (const auto& [side, bins] :
         {std::pair(12, 8), std::pair(12, 32), std::pair(24, 12), std::pair(48, 8)}) {
      const double ratio =
          formFactor(linkedWith(arrangement.scene, side, bins, "one"), 0, 1) / arrangement.factor;
      least = std::min(least, ratio), most = std::max(most, ratio);
    }
  CAPTURE(least, most);
  CHECK(least < 0.5);
  CHECK(most > 1.06);
}

TEST_CASE("what elements of the Cornell box see is what rays see") {
  const Scene scene = loadScene(sourceDirectory() / "scenes/cornell.scene");
  const LinkedScene made = linked(scene, {{{"elements", 4096}}, {{"bins", 12}}, {}});
  const ElementTree& tree = made.tree();
  const glm::dvec3 origin = snapshotOf(scene, 0.0).origin;
  Scene placed = scene;  // everything in the world
  for (const Object& object : placed.objects)
    for (std::uint32_t v = object.firstVertex; v < object.firstVertex + object.vertexCount; ++v)
      placed.positions[v] = glm::vec3(object.placement * glm::dvec4(glm::dvec3(placed.positions[v]), 1.0) -
                                      glm::dvec4(origin, 0.0));
  const DirectionBins directions(12, BinMapping::even);
  double links = 0.0, open = 0.0, bins = 0.0, asRays = 0.0;
  for (std::uint32_t leaf = 0; leaf < tree.leafCount; leaf += 41) {
    const glm::dvec3 eye(made.state().position[leaf]), normal(made.state().normal[leaf]);
    // Elements of a room have about one size, whatever the size of the node that is seen.
    const double element = 2.0 * static_cast<double>(made.state().radius[leaf]);
    std::map<std::uint32_t, ElementLink> seen;
    for (const ElementLink& link : made.seenBy(leaf)) seen[link.bin()] = link;
    for (std::uint32_t bin = 0; bin < directions.count(); ++bin) {
      const glm::dvec3 ray(directions.centre(bin));
      if (glm::dot(normal, ray) <= 0.0) continue;  // into the wall
      bins += 1.0;
      const double along = firstHit(placed, eye, ray, 1e-6).distance;
      if (!seen.contains(bin)) {
        asRays += std::isinf(along);
        continue;
      }
      const ElementLink& link = seen[bin];
      asRays += std::abs(along - static_cast<double>(link.distance())) <= 0.1 * along + 1.5 * element;
      links += 1.0;
      const glm::dvec3 away = glm::dvec3(made.state().position[link.node]) - eye;
      const double distance = glm::length(away);
      open +=
          firstHit(placed, eye, away / distance, 1e-6).distance > distance - std::max(1e-4, 0.5 * element);
    }
  }
  CAPTURE(tree.leafCount, links, open / links, bins, asRays / bins);
  CHECK(links > 10000.0);
  CHECK(open / links >= 0.94);
  CHECK(asRays / bins >= 0.94);
}

TEST_CASE(
    "a disc of elements is where triangles are: links agree with the sum over all elements and rays (Eq. 4)") {
  // Irradiance of the floor in light of radiance 1 from one wall of the furnished cube: the sum of Eq. 4 over
  // elements with traced visibility; the disc factor A cos cos / (pi r^2 + A) is bounded.
  const Scene scene = furnishedCube();
  const LinkedScene made = linked(scene, {{{"elements", 1500}}, {{"bins", 12}}, {}});
  const ElementTree& tree = made.tree();
  const glm::dvec3 origin = snapshotOf(scene, 0.0).origin;
  Scene placed = scene;
  for (glm::vec3& position : placed.positions) position = glm::vec3(glm::dvec3(position) - origin);
  const BinWeights weights(made.links);
  double square = 0.0, mean = 0.0, linkMean = 0.0, count = 0.0;
  for (std::uint32_t leaf = 0; leaf < tree.leafCount; leaf += 7) {
    if (tree.objectOfNode[leaf] != 2) continue;
    const glm::dvec3 eye(made.state().position[leaf]), normal(made.state().normal[leaf]);
    double exact = 0.0, byLinks = 0.0;
    for (std::uint32_t other = 0; other < tree.leafCount; ++other) {
      if (tree.objectOfNode[other] != 0) continue;
      const glm::dvec3 away = glm::dvec3(made.state().position[other]) - eye;
      const double r = glm::length(away), area = static_cast<double>(made.state().area[other]);
      const double cosines = std::max(glm::dot(normal, away) / r, 0.0) *
                             std::max(-glm::dot(glm::dvec3(made.state().normal[other]), away) / r, 0.0);
      if (cosines > 0.0 && firstHit(placed, eye, away / r, 1e-6).distance > r - 1e-3)
        exact += kPi * area * cosines / (kPi * r * r + area);
    }
    for (const ElementLink& link : made.seenBy(leaf))
      if (tree.objectOfNode[link.node] == 0)
        byLinks += std::max(weights(made.state().normal[leaf], link.bin()), 0.0) *
                   weights.scale(made.state().normal[leaf]);
    square += (byLinks - exact) * (byLinks - exact);
    mean += exact;
    linkMean += byLinks;
    count += 1.0;
  }
  REQUIRE(count > 10.0);
  CAPTURE(count, mean / count, linkMean / mean, std::sqrt(square / count));
  CHECK(linkMean == Approx(mean).epsilon(0.05));
  // A wall takes some ten bins: each is an all or nothing of it.
  CHECK(std::sqrt(square / count) < 0.2 * mean / count);
}

TEST_CASE(
    "as printed, the sum over elements makes light from nothing in a cube, with a bounded disc factor hardly any") {
  const LinkedScene made = linked(closedCube(), {{{"elements", 600}}, {{"bins", 1}}, {{"fill", "one"}}});
  const ElementState& state = made.state();
  double printed = 0.0, bounded = 0.0;
  for (std::uint32_t leaf = 0; leaf < made.tree().leafCount; ++leaf) {
    double printedSum = 0.0, boundedSum = 0.0;
    for (std::uint32_t other = 0; other < made.tree().leafCount; ++other) {
      const glm::dvec3 away = state.position[other] - state.position[leaf];
      const double squared = glm::dot(away, away), area = static_cast<double>(state.area[other]);
      if (!(squared > 0.0)) continue;
      const double cosines = std::max(glm::dot(glm::dvec3(state.normal[leaf]), away), 0.0) *
                             std::max(-glm::dot(glm::dvec3(state.normal[other]), away), 0.0) / squared;
      printedSum += area * cosines / (kPi * squared);
      boundedSum += area * cosines / (kPi * squared + area);
    }
    printed = std::max(printed, printedSum);
    bounded = std::max(bounded, boundedSum);
  }
  CAPTURE(printed, bounded);
  CHECK(printed > 1.2);
  CHECK(bounded < 1.06);
}
