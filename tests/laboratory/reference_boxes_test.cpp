// The reference of the boxes against closed forms.
#include <cmath>

#include "lumivox/base/error.h"
#include "lumivox/reference/voxel_transport.h"
#include "support/facts.h"
#include "support/support.h"

using namespace lumivox;
using lumivox::test::Tells;

namespace {

const GridPlacement kGrid{glm::vec3(-4.0f), 0.5f, glm::ivec3(16)};

BoxTransport shining(double radiance) {
  BoxTransport transport;
  transport.radiance = [=](const BoxHit&) { return glm::dvec3(radiance); };
  transport.samples = 20000;
  return transport;
}

}  // namespace

TEST_CASE("a ray meets the nearest box, enters and leaves it by its slabs, and no further than its reach") {
  const std::vector<glm::ivec3> voxels{{10, 8, 8}, {12, 8, 8}, {8, 8, 8}};
  const VoxelBoxes boxes(voxels, kGrid);
  // From (0.6, 0.25, 0.25): behind box 8, which ends at 0.5; box 10 is from 1 to 1.5.
  const auto hit = boxes.first({0.6, 0.25, 0.25}, {1, 0, 0}, 100);
  REQUIRE(hit);
  CHECK(hit->voxel == glm::ivec3(10, 8, 8));
  CHECK(hit->enter == Approx(0.4).epsilon(1e-12));
  CHECK(hit->leave == Approx(0.9).epsilon(1e-12));
  CHECK(hit->middle().x == Approx(1.25).epsilon(1e-12));
  CHECK_FALSE(boxes.first({0.6, 0.25, 0.25}, {1, 0, 0}, 0.399999));
  CHECK(boxes.first({0.6, 0.25, 0.25}, {1, 0, 0}, 0.400001));
  CHECK_FALSE(boxes.first({0.6, 0.25, 0.25}, {0, 1, 0}, 100));
  const auto inside = boxes.first({0.25, 0.25, 0.25}, {0, 0, -1}, 100);
  REQUIRE(inside);
  CHECK(inside->enter == 0.0);
  CHECK(inside->leave == Approx(0.25).epsilon(1e-12));
  CHECK_FALSE(VoxelBoxes({}, kGrid).first({0, 0, 0}, {1, 0, 0}, 100));
}

TEST_CASE("a ray ends at the surface within a box, or passes the box and ends in the next") {
  const std::vector<glm::ivec3> voxels{{10, 8, 8}, {12, 8, 8}};
  // Nothing stops rays in the first box; in the other they end at a quarter of it.
  const VoxelBoxes boxes(voxels, kGrid, [](const BoxHit& hit) -> std::optional<BoxStop> {
    if (hit.voxel.x == 10) return std::nullopt;
    return BoxStop{hit.enter + 0.25 * (hit.leave - hit.enter), {-1, 0, 0}};
  });
  // From 0: the boxes are from 1 to 1.5 and from 2 to 2.5.
  const auto hit = boxes.first({0, 0.25, 0.25}, {1, 0, 0}, 100);
  REQUIRE(hit);
  CHECK(hit->voxel == glm::ivec3(12, 8, 8));
  CHECK(hit->enter == Approx(2.0).epsilon(1e-12));
  CHECK(hit->place().x == Approx(2.125).epsilon(1e-12));
  CHECK(hit->normal == glm::dvec3(-1, 0, 0));
  CHECK_FALSE(boxes.first({0, 0.25, 0.25}, {1, 0, 0}, 2.12));
  CHECK(VoxelBoxes(voxels, kGrid).first({0, 0.25, 0.25}, {1, 0, 0}, 100)->place().x ==
        Approx(1.0).epsilon(1e-12));
}

TEST_CASE("a ceiling of boxes takes its form factor of occlusion and of light, the sky the rest") {
  std::vector<glm::ivec3> voxels;
  for (int x = 4; x < 12; ++x)
    for (int z = 4; z < 12; ++z) voxels.push_back({x, 10, z});
  const VoxelBoxes boxes(voxels, kGrid);
  // A square of 4 m, 1 m above: of a quarter F = X / sqrt(1 + X^2) atan(X / sqrt(1 + X^2)) / pi, X = 2.
  const double x = 2.0 / std::sqrt(5.0), expected = 4.0 * x * std::atan(x) / 3.14159265358979;
  BoxTransport transport = shining(3.0);
  transport.environment = glm::dvec3(1.0);
  transport.occlusionDistance = 100.0;
  const std::vector<BoxStart> starts(20, {{0, 0, 0}, {0, 1, 0}});
  const std::vector<BoxLight> lights = transportThroughBoxes(boxes, starts, transport);
  double light = 0.0, open = 0.0;
  for (const BoxLight& one : lights) {
    CHECK(std::abs(one.open - (1.0 - expected)) < 5.0 * std::sqrt(one.openVariance));
    // Two values, 1 and 3: a variance of 4 p (1 - p) over the samples.
    CHECK(one.variance.x == Approx(4.0 * expected * (1.0 - expected) / 20000).epsilon(0.05));
    light += one.arriving.x / 20.0;
    open += one.open / 20.0;
  }
  CHECK(open == Approx(1.0 - expected).epsilon(0.01));
  CHECK(light == Approx(1.0 + 2.0 * expected).epsilon(0.005));
}

TEST_CASE("in a closed room of albedo a every further bounce brings a times the one before") {
  std::vector<glm::ivec3> voxels;
  for (int x = 0; x < 16; ++x)
    for (int y = 0; y < 16; ++y)
      for (int z = 0; z < 16; ++z)
        if (std::min({x, y, z}) == 0 || std::max({x, y, z}) == 15) voxels.push_back({x, y, z});
  const VoxelBoxes boxes(voxels, kGrid);
  BoxTransport transport = shining(2.0);
  transport.samples = 64;
  transport.surface = [](const BoxHit& hit) {
    // On from the middle of the room: a direction from there meets a wall again.
    return BoxSurface{{glm::dvec3(0.1), -glm::normalize(hit.direction)}, glm::dvec3(0.5)};
  };
  const std::vector<BoxStart> starts{{{0.3, 0.2, -0.4}, {0, 0, 1}}, {{0, 0, 0}, {0, 0, 0}}};
  for (int bounces = 1; bounces <= 4; ++bounces) {
    transport.bounces = bounces;
    const std::vector<BoxLight> lights = transportThroughBoxes(boxes, starts, transport);
    CHECK(lights[0].arriving.x == Approx(2.0 * (2.0 - std::pow(0.5, bounces - 1))).epsilon(1e-12));
    CHECK(lights[1].arriving.x == 0.0);  // no ray begins there
  }
}

TEST_CASE("the reference of the boxes says what it lacks") {
  const VoxelBoxes boxes({}, kGrid);
  BoxTransport transport = shining(1.0);
  transport.samples = 1;
  CHECK_THROWS_MATCHES(transportThroughBoxes(boxes, {}, transport), Error, Tells(1, "samples", 2));
  transport.samples = 2;
  transport.bounces = 2;
  CHECK_THROWS_MATCHES(transportThroughBoxes(boxes, {}, transport), Error, Tells(2, "bounces", "nothing"));
}
