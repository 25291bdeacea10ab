// Closed forms of the volume: what two bands of light make of skies, floors, single voxels and closed rooms.
#include "support/imperfect_volumes.h"

#include <algorithm>
#include <cmath>

#include "lumivox/base/error.h"
#include "support/facts.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::volumes;

namespace {

/// A floor of a single layer under open air.
Volume floorOf(int side, int height, double radiance) {
  Volume volume({side, side, height});
  return volume.occupyWhere([](const glm::ivec3& voxel) { return voxel.z == 0; },
                            [](const glm::ivec3&) { return glm::dvec3(0, 0, 1); }, radiance);
}

}  // namespace

TEST_CASE("a constant environment arrives exactly, however few or many rays there are") {
  const Volume empty({5, 4, 3});
  for (const double rays : {2.0, 3.0, 100.0, 4096.0})
    for (const char* walk : {"steps", "exact"}) {
      INFO(rays << " rays, " << walk);
      const ShGrid light = arriving(empty, {{"rays", rays}, {"walk", walk}}, 3.0);
      REQUIRE(light.quantity == ShGrid::Quantity::radiance);
      for (const glm::ivec3& voxel : {glm::ivec3(0), glm::ivec3(2, 1, 1), glm::ivec3(4, 3, 2)}) {
        const glm::dvec4 found = coefficientsIn(light, voxel), expected(constant(3.0));
        for (int c = 0; c < 4; ++c) CHECK(found[c] == Approx(expected[c]).margin(3e-5));
      }
      for (const char* voxels : {"six", "eight", "own", "trilinear"})
        CHECK(gatheredAt(empty, light, {{2.3f, 1.9f, 1.2f}, glm::normalize(glm::vec3(1, 2, 3))},
                         {{"voxels", voxels}}) == Approx(3.0).epsilon(1e-5));
    }
}

TEST_CASE("however many rays there are, none is lost, with eight voxels to look at for every step too") {
  const Volume empty({8, 8, 8});
  for (const char* reading : {"nearest", "linear"})
    for (const char* walk : {"steps", "exact"}) {
      LonePass march =
          marching(empty, {{"rays", 40000}, {"reading", reading}, {"walk", walk}, {"voxels", "own"}}, 3.0);
      march.in("gbuffer", seen({{{4.5f, 4.5f, 4.5f}, {0, 0, 1}}}));
      INFO(reading << ", " << walk);
      CHECK(coefficientsIn(march.out<ShGrid>("incoming"), {4, 4, 4}).x ==
            Approx(double{constant(3.0).x}).epsilon(1e-4));
    }
}

TEST_CASE("an odd number of rays counts as the next one") {
  const Volume room = closedRoom(5, 1.0);
  const auto bits = [&](double rays) {
    return arriving(room, {{"rays", rays}, {"source", "harmonics"}})
        .levels[0]
        .coefficients[0]
        ->downloadFloats(0);
  };
  CHECK(bits(3) == bits(4));
  CHECK(bits(3) != bits(2));
}

TEST_CASE(
    "a point over a wide floor under an open sky receives pi L, to which a floor that shines adds nothing") {
  // Of the directions below the horizon those that leave beside the floor see the sky.
  constexpr int kSide = 192;
  const ReadPoint above{{96.5f, 96.5f, 1.5f}, {0, 0, 1}};
  for (const double floor : {0.0, 2.0}) {
    const Volume volume = floorOf(kSide, 6, floor);
    for (const char* source : {"surface", "harmonics"}) {
      LonePass march = marching(volume, {{"rays", 2000}, {"source", source}, {"voxels", "own"}}, 1.0);
      march.in("gbuffer", seen({above}));
      const double found = gatheredAt(volume, march.out<ShGrid>("incoming"), above, {{"voxels", "own"}});
      INFO(source << ", floor " << floor << ": " << found);
      // As harmonics the floor shines floor (1/2 + 3/4 cos), whose integral with 1/4 + 1/2 cos over the lower
      // half is -pi floor / 16.
      const double expected = std::string(source) == "surface" ? 1.0 : 1.0 - floor / 16.0;
      CHECK(found == Approx(expected).epsilon(0.01));
    }
  }
}

TEST_CASE("a small bright voxel counts 3/4 of its irradiance overhead, 1/4 at the horizon and less below") {
  // The kernel of two bands is 1/4 + 1/2 cos over the whole sphere.
  const auto found = [](const glm::ivec3& place) {
    Volume volume({25, 25, 25});
    volume.occupy(place, {0, 0, 1}, 1.0, 1.0);
    const ReadPoint middle{{12.5f, 12.5f, 12.5f}, {0, 0, 1}};
    LonePass march = marching(volume, {{"rays", 200000}, {"walk", "exact"}, {"voxels", "own"}});
    march.in("gbuffer", seen({middle}));
    const ShGrid light = march.out<ShGrid>("incoming");
    return gatheredAt(volume, light, middle, {{"voxels", "own"}}) -
           gatheredAt(volume, light, middle, {{"voxels", "own"}}, "clipped");
  };
  // Solid angle of a cube of a metre at ten metres along an axis: its near face.
  constexpr double kNear = 9.5;
  const double solidAngle = 4.0 * std::asin(0.25 / (kNear * kNear + 0.25));
  CHECK(found({12, 12, 22}) == Approx(0.75 * solidAngle / kPi).epsilon(0.03));
  CHECK(found({22, 12, 12}) == Approx(0.25 * solidAngle / kPi).epsilon(0.03));
  CHECK(found({12, 12, 2}) == Approx(-0.25 * solidAngle / kPi).epsilon(0.03));
}

TEST_CASE("in a closed room whose walls shine L every surface receives L") {
  for (const int inside : {8, 16, 32}) {
    const Volume room = closedRoom(inside, 2.0);
    const ShGrid light = arriving(room, {{"rays", 200}});
    const std::vector<double> found = gathered(room, light, wallsOf(room));
    INFO(inside << " voxels: " << meanOf(found));
    CHECK(*std::min_element(found.begin(), found.end()) == Approx(2.0).epsilon(0.01));
    CHECK(*std::max_element(found.begin(), found.end()) == Approx(2.0).epsilon(0.01));
  }
}

TEST_CASE("where occupied neighbours count they darken the edges of a closed room") {
  // Walls at the inner faces of their voxels: farther out the voxels beside the point are occupied
  // everywhere.
  for (const int inside : {8, 16, 32}) {
    const Volume room = closedRoom(inside, 1.0);
    const Settings all{{"blend", "all"}};
    const ShGrid surface = arriving(room, {{"rays", 200}}),
                 harmonics = arriving(room, {{"rays", 200}, {"source", "harmonics"}});
    const auto mean = [&](const ShGrid& light, float before) {
      return meanOf(gathered(room, light, wallsOf(room, before), all));
    };
    INFO(inside << " voxels: surface " << mean(surface, 0.499f) << ", harmonics " << mean(harmonics, 0.499f));
    CHECK(mean(surface, 0.499f) >= 0.94);
    CHECK(mean(surface, 0.499f) <= 1.01);
    CHECK(mean(harmonics, 0.499f) >= 0.93);
    CHECK(mean(harmonics, 0.499f) <= 1.03);
    INFO("in the middle of the voxels " << mean(surface, 0.0f));
    CHECK(mean(surface, 0.0f) >= 0.87);
    CHECK(mean(surface, 0.0f) < mean(surface, 0.499f) - 0.05);
  }
}

TEST_CASE(
    "by two bands a ball that shines L gives 5/4 of it in its middle, and less towards the wall's 7/8") {
  // Ways of angle theta to the radius meet the wall of a ball of radius 1 from rho on at sin alpha = rho sin
  // theta. Of (1/4 + 1/2 cos theta) (1/2 + 3/4 cos alpha) the odd part is 0 over the sphere, and the mean of
  // cos alpha is that of sqrt(1 - rho^2 + rho^2 c^2) for c from 0 to 1: 1/2 + 3/4 of it, at the wall 15/16
  // from across and -1/16 from the wall beneath.
  constexpr int kSide = 44;
  constexpr double kRadius = 20.0;
  const glm::dvec3 middle(0.5 * kSide);
  const auto fromMiddle = [&](const glm::ivec3& voxel) { return glm::dvec3(voxel) + 0.5 - middle; };
  Volume ball({kSide, kSide, kSide});
  ball.occupyWhere([&](const glm::ivec3& voxel) { return glm::length(fromMiddle(voxel)) > kRadius; },
                   [&](const glm::ivec3& voxel) { return glm::normalize(-fromMiddle(voxel)); }, 1.0);
  for (const double rho : {0.0, 0.5, 0.8, 0.9}) {
    std::vector<ReadPoint> points;
    double expected = 0.0;
    ball.forEach([&](const glm::ivec3& voxel) {
      const double length = glm::length(fromMiddle(voxel)), k = length * length / (kRadius * kRadius);
      if (std::abs(length / kRadius - rho) > (rho > 0.0 ? 0.005 : 0.05)) return;
      points.push_back({glm::vec3(voxel) + 0.5f, glm::normalize(-fromMiddle(voxel))});
      expected += 0.5 + 0.375 * (1.0 + (1.0 - k) / std::sqrt(k) * std::asinh(std::sqrt(k / (1.0 - k))));
    });
    expected /= static_cast<double>(points.size());
    LonePass march = volumePass("march", underSky(0.0), static_cast<int>(points.size()));
    march.in("opacity", ball.opacity())
        .in("reflected", ball.reflected())
        .in("attributes", ball.attributes())
        .in("gbuffer", seen(points))
        .with({{"rays", 400}, {"source", "harmonics"}, {"voxels", "own"}});
    const double found = meanOf(gathered(ball, march.out<ShGrid>("incoming"), points, {{"voxels", "own"}}));
    CAPTURE(rho, points.size());
    CHECK(found == Approx(expected).epsilon(0.015));
    // The side that is seen shines L, wherever it is seen from.
    march.with({{"source", "surface"}});
    CHECK(meanOf(gathered(ball, march.out<ShGrid>("incoming"), points, {{"voxels", "own"}})) ==
          Approx(1.0).epsilon(0.01));
  }
}

TEST_CASE("N bounces in a closed room at albedo a give L (1 + a + ... + a^(N-1))") {
  const int inside = 8;
  for (const double albedo : {0.5, 0.9}) {
    const Volume room = closedRoom(inside, 1.0, albedo);
    for (const int bounces : {2, 4, 16}) {
      double expected = 0.0;
      for (int b = 0; b < bounces; ++b) expected += std::pow(albedo, b);
      const ShGrid light = arriving(room, {{"rays", 200}, {"bounces", static_cast<double>(bounces)}});
      const double found = meanOf(gathered(room, light, wallsOf(room)));
      INFO("albedo " << albedo << ", " << bounces << " bounces: " << found << ", expected " << expected);
      CHECK(found == Approx(expected).epsilon(0.03));
    }
  }
}

TEST_CASE("a voxel sends what the side that is seen sends, though its two bands say 1/2 + 3/4 cos") {
  // One wall of normal +x that sends 1 forwards and 4 backwards; a ray of a voxel beyond sees it alone.
  for (const bool inFront : {true, false}) {
    Volume volume({9, 9, 9});
    volume.occupyWhere([](const glm::ivec3& voxel) { return voxel.x == 4; },
                       [](const glm::ivec3&) { return glm::dvec3(1, 0, 0); }, 1.0, 4.0);
    const ShGrid light = arriving(volume, {{"rays", 4000}});
    const glm::dvec4 found = coefficientsIn(light, {inFront ? 6 : 2, 4, 4});
    // From all directions that meet the wall comes the same radiance.
    const ShGrid ones =
        arriving(Volume(volume).occupyWhere([](const glm::ivec3& voxel) { return voxel.x == 4; },
                                            [](const glm::ivec3&) { return glm::dvec3(1, 0, 0); }, 1.0, 1.0),
                 {{"rays", 4000}});
    const glm::dvec4 share = coefficientsIn(ones, {inFront ? 6 : 2, 4, 4});
    for (int c = 0; c < 4; ++c) CHECK(found[c] == Approx((inFront ? 1.0 : 4.0) * share[c]).margin(1e-4));
  }
}

TEST_CASE("sheets back to back, whose normals cancel out, still show each side its own light") {
  Volume volume({9, 9, 9});
  volume.occupyWhere([](const glm::ivec3& voxel) { return voxel.x == 4; },
                     [](const glm::ivec3&) { return glm::dvec3(1, 0, 0); }, 1.0, 3.0);
  // Coefficients stay; only the normals of the attributes are gone.
  AttributeGrid attributes = volume.attributes();
  attributes.normal->clear(glm::vec4(0.0f));
  // Yellow, so that no colour alone tells the direction by its difference from another.
  ShGrid yellow = volume.reflected();
  yellow.levels[0].coefficients[2] =
      volumeTexture(volume.size(), gpu::Format::rgba32f, std::vector<float>(4 * volume.grid().voxelCount()));
  LonePass march = marching(volume, {{"rays", 4000}}), right = marching(volume, {{"rays", 4000}});
  march.in("attributes", attributes).in("reflected", yellow);
  right.in("reflected", yellow);
  const ShGrid found = march.out<ShGrid>("incoming"), expected = right.out<ShGrid>("incoming");
  for (const int x : {2, 6})
    for (int c = 0; c < 4; ++c)
      CHECK(coefficientsIn(found, {x, 4, 4})[c] ==
            Approx(coefficientsIn(expected, {x, 4, 4})[c]).margin(1e-4));
}

TEST_CASE("a lone voxel never meets itself, and without a guard always") {
  Volume volume({7, 7, 7});
  volume.occupy({3, 3, 3}, {0, 0, 1}, 1.0, 1.0);
  for (const char* walk : {"steps", "exact"}) {
    const auto own = [&](Settings settings) {
      settings.push_back({"rays", 5000});
      settings.push_back({"walk", walk});
      return coefficientsIn(arriving(volume, settings), {3, 3, 3});
    };
    INFO(walk);
    CHECK(own({}) == glm::dvec4(0.0));
    CHECK(own({{"guard", 0}}).x == Approx(double{constant(1.0).x}).epsilon(1e-4));
  }
}

TEST_CASE("steps never miss walls of one voxel that face an axis; across edges some slip through") {
  const Volume room = closedRoom(9, 1.0);
  const ShGrid inRoom = arriving(room, {{"rays", 3000}});
  room.forEach([&](const glm::ivec3& voxel) {
    if (room.set().contains(voxel) || voxel.x % 4 != 1 || voxel.y % 3 != 1) return;
    CHECK(coefficientsIn(inRoom, voxel).x == Approx(double{constant(1.0).x}).epsilon(1e-5));
  });
  Volume slanted({17, 17, 17});
  slanted.occupyWhere([](const glm::ivec3& voxel) { return voxel.x + voxel.z == 20; },
                      [](const glm::ivec3&) { return glm::normalize(glm::dvec3(-1, 0, -1)); }, 1.0, 1.0);
  const auto mean = [&](const char* walk) {
    LonePass march = marching(slanted, {{"rays", 10000}, {"walk", walk}, {"voxels", "own"}});
    march.in("gbuffer", seen({{{8.5f, 8.5f, 8.5f}, {0, 0, 1}}}));
    return coefficientsIn(march.out<ShGrid>("incoming"), {8, 8, 8}).x;
  };
  const double slipped = 1.0 - mean("steps") / mean("exact");
  INFO("through a sheet of voxels that touch at edges alone: " << slipped);
  CHECK(slipped == Approx(0.13).margin(0.02));  // as the card has it
}

TEST_CASE("marching on behind what is met changes no bit") {
  const Volume room = closedRoom(8, 1.5);
  for (const char* reading : {"nearest", "linear"}) {
    const auto bits = [&](const char* exit) {
      return arriving(room, {{"exit", exit}, {"reading", reading}}, 0.25)
          .levels[0]
          .coefficients[1]
          ->downloadFloats(0);
    };
    CHECK(bits("early") == bits("branchless"));
  }
}

TEST_CASE("one set of directions for all voxels gives equal voxels equal light") {
  // A wide floor, seen from two places in the same distance to everything but the border.
  Volume volume({16, 16, 8});
  volume.occupyWhere([](const glm::ivec3& voxel) { return voxel.z == 0 && voxel.x % 4 == 0; },
                     [](const glm::ivec3&) { return glm::dvec3(0, 0, 1); }, 1.0);
  const auto found = [&](const char* directions, const glm::ivec3& voxel) {
    return coefficientsIn(arriving(volume, {{"rays", 30}, {"directions", directions}}), voxel);
  };
  // Mirrored along y, which a shared set is not, so only voxels that are moved along y compare.
  CHECK(std::abs(found("shared", {8, 7, 1}).x - found("shared", {8, 8, 1}).x) <=
        std::abs(found("voxel", {8, 7, 1}).x - found("voxel", {8, 8, 1}).x));
}

TEST_CASE("only the voxels that surfaces read are filled, and the picture is the same to the bit") {
  const Volume room = closedRoom(12, 1.0, 0.7);
  const std::vector<ReadPoint> points{{{0.4f, 5.2f, 7.7f}, {1, 0, 0}},
                                      {{0.6f, 6.9f, 3.1f}, glm::normalize(glm::vec3(1, 0.3, -0.2))},
                                      {{7.3f, 0.5f, 9.8f}, {0, 1, 0}}};
  for (const char* voxels : {"six", "eight", "own", "trilinear"})
    for (const char* filter : {"on", "off"})
      for (const double bounces : {1.0, 3.0}) {
        const Settings reads{{"voxels", voxels}, {"filter", filter}};
        LonePass march = marching(room, {{"rays", 30}, {"bounces", bounces}});
        march.with(reads).in("gbuffer", seen(points));
        const ShGrid further = march.out<ShGrid>("incoming");
        march.keepOnly("incoming");
        const ShGrid part = march.out<ShGrid>("incoming");
        march.with({{"cover", "all"}});
        const ShGrid all = march.out<ShGrid>("incoming");
        INFO(voxels << ", filter " << filter << ", " << bounces << " bounces");
        CHECK(gathered(room, part, points, reads) == gathered(room, all, points, reads));
        const auto filled = [](const ShGrid& light) {
          const std::vector<float> values = light.levels[0].coefficients[0]->downloadFloats(0);
          return values.size() - static_cast<std::size_t>(std::count(values.begin(), values.end(), 0.0f));
        };
        if (bounces == 1.0) CHECK(filled(part) < filled(all) / 4);
        // 'carried' is for surfaces that no pixel sees, too.
        CHECK(gathered(room, further, points, reads) == gathered(room, all, points, reads));
        if (bounces == 1.0) CHECK(filled(further) > filled(part));
        CHECK(all.readFor.empty());
        CHECK_FALSE(part.readFor.empty());
      }
}

TEST_CASE("openness before a long wall is that of its kernel, and on an open floor 1") {
  // Two bands weigh the open directions with 1/4 + 1/2 cos.
  constexpr int kSide = 96, kHeight = 24, kBehind = 60, kWall = 10;
  Volume floor({kSide, kSide, kHeight});
  const auto isFloor = [](const glm::ivec3& voxel) { return voxel.z == 0; };
  const auto up = [](const glm::ivec3&) { return glm::dvec3(0, 0, 1); };
  floor.occupyWhere(isFloor, up, 0.0);
  Volume walled = floor;
  walled.occupyWhere(
      [](const glm::ivec3& voxel) { return voxel.x == kBehind && voxel.z >= 1 && voxel.z <= kWall; },
      [](const glm::ivec3&) { return glm::dvec3(-1, 0, 0); }, 0.0);
  const ReadPoint point{{48.5f, 48.5f, 1.5f}, {0, 0, 1}};
  const auto openness = [&](const Volume& volume) {
    LonePass occlude = volumePass("occlude", underSky(0.0));
    occlude.in("opacity", volume.opacity())
        .in("bits", volume.bits())
        .in("gbuffer", seen({point}))
        .with({{"rays", 20000}, {"distance", 1000}, {"walk", "exact"}, {"voxels", "own"}});
    return gatheredAt(volume, occlude.out<ShGrid>("visibility"), point, {{"voxels", "own"}}, "occlusion");
  };
  CHECK(openness(floor) == Approx(1.0).epsilon(0.01));
  // Directions that the near face of the wall takes away: x from the wall's foot to its top.
  constexpr double kFar = kBehind - 48.5, kFoot = 1.0 - 1.5, kTop = kWall + 1.0 - 1.5, kLong = 47.5;
  double lost = 0.0;
  constexpr int kSteps = 400;
  for (int i = 0; i < kSteps; ++i)
    for (int j = 0; j < 4 * kSteps; ++j) {
      const double z = kFoot + (kTop - kFoot) * (i + 0.5) / kSteps,
                   y = kLong * (2.0 * (j + 0.5) / (4 * kSteps) - 1.0), r2 = kFar * kFar + y * y + z * z;
      const double solidAngle =
          kFar / std::pow(r2, 1.5) * (kTop - kFoot) / kSteps * 2.0 * kLong / (4 * kSteps);
      // Below the horizon the floor is met anyway.
      if (z > kFoot) lost += solidAngle * (0.25 + 0.5 * z / std::sqrt(r2)) * (z > 0.0 ? 1.0 : 0.0);
    }
  const double quadrature = 1.0 - lost / kPi, exact = 1.0 - 0.5 * (1.0 - kFar / std::hypot(kFar, kTop));
  INFO("quadrature of two bands " << quadrature << ", exact " << exact);
  CHECK(openness(walled) == Approx(quadrature).epsilon(0.01));
}

TEST_CASE("what two bands make negative is cut off and told, or kept as the difference of both sides") {
  const Volume empty({3, 3, 3});
  ShGrid light;
  light.quantity = ShGrid::Quantity::radiance;
  std::vector<float> values;
  // Light from below alone, more concentrated than a surface that looks up can bear.
  for (int i = 0; i < 27; ++i) values.insert(values.end(), {1.0f, 0.0f, -2.0f, 0.0f});
  const gpu::TextureRef volume = volumeTexture({3, 3, 3}, gpu::Format::rgba32f, values);
  light.levels.push_back({empty.grid(), {volume, nullptr, nullptr}});
  const ReadPoint up{{1.5f, 1.5f, 1.5f}, {0, 0, 1}};
  const double mean = kY0, net = 2.0 / 3.0 * kY1 * -2.0;
  REQUIRE(mean + net < 0.0);
  CHECK(gatheredAt(empty, light, up) == 0.0);
  CHECK(gatheredAt(empty, light, up, {}, "clipped") == Approx(-(mean + net)).epsilon(1e-5));
  CHECK(gatheredAt(empty, light, up, {{"negative", "closure"}}) ==
        Approx(std::hypot(mean, net) + net).epsilon(1e-5));
}

TEST_CASE("the weights of Eq. 5 are cosines of the ways from the surface point, over their sum") {
  // Voxels that hold their number; the six neighbours of the voxel above a floor point.
  const Volume volume({5, 5, 5});
  const auto numbered = [](const glm::ivec3& voxel) {
    return 1.0 + voxel.x + 7.0 * voxel.y + 31.0 * voxel.z;
  };
  const ShGrid light = evenLight(volume, [&](const glm::ivec3& voxel, int) { return numbered(voxel); });
  const glm::dvec3 place(2.3, 2.6, 1.9), normal = glm::normalize(glm::dvec3(0.2, -0.3, 1.0));
  const auto expected = [&](bool six) {
    const glm::dvec3 shifted = place + 0.5 * normal;
    double sum = 0.0, weights = 0.0;
    for (int i = 0; i < (six ? 6 : 8); ++i) {
      glm::dvec3 at = six ? glm::floor(shifted) + 0.5 : glm::floor(shifted - 0.5) + 0.5;
      if (six)
        at[i / 2] += i % 2 == 0 ? -1.0 : 1.0;
      else
        at += glm::dvec3(i & 1, i >> 1 & 1, i >> 2);
      const double weight = std::max(glm::dot(normal, glm::normalize(at - place)), 0.0);
      sum += weight * numbered(glm::ivec3(glm::floor(at)));
      weights += weight;
    }
    return sum / weights;
  };
  const ReadPoint point{place, normal};
  CHECK(gatheredAt(volume, light, point, {{"filter", "off"}}) == Approx(expected(true)).epsilon(1e-4));
  CHECK(gatheredAt(volume, light, point, {{"filter", "off"}, {"voxels", "eight"}}) ==
        Approx(expected(false)).epsilon(1e-4));
  CHECK(gatheredAt(volume, light, point, {{"voxels", "own"}}) ==
        Approx(numbered(glm::ivec3(glm::floor(place)))).epsilon(1e-5));
  // The numbers are linear, so that between voxels they are known too.
  const glm::dvec3 shifted = place + 0.5 * normal - 0.5;
  CHECK(gatheredAt(volume, light, point, {{"voxels", "trilinear"}}) ==
        Approx(1.0 + shifted.x + 7.0 * shifted.y + 31.0 * shifted.z).epsilon(1e-4));
}

TEST_CASE("errors of imperfect volumes say what does not fit together") {
  const Volume volume({4, 4, 4}), other({4, 4, 5});
  const auto march = [&](const ShGrid& reflected, const Settings& settings) {
    LonePass runner = volumePass("march", underSky(1.0));
    runner.in("opacity", volume.opacity())
        .in("reflected", reflected)
        .in("attributes", volume.attributes())
        .with(settings);
    runner.out<ShGrid>("incoming");
  };
  ShGrid flux = volume.reflected();
  flux.quantity = ShGrid::Quantity::flux;
  CHECK_THROWS_MATCHES(march(flux, {}), Error, Tells("reflected", "flux", "W/sr", "radiance", "W/(sr m^2)"));
  CHECK_THROWS_MATCHES(march(other.reflected(), {}), Error,
                       Tells("reflected", "4 x 4 x 5", "opacity", "4 x 4 x 4"));
  CHECK_THROWS_MATCHES(march(volume.reflected(), {{"guard", 7}}), Error, Tells("guard", 7, 6.9282));
  CHECK_THROWS_MATCHES(march(volume.reflected(), {{"walk", "exact"}}), Error, Tells("walk exact", "bits"));
  CHECK_THROWS_MATCHES(marching(volume, {{"walk", "exact"}, {"occupied", 0.25}}).run(), Error,
                       Tells("walk exact", "occupied", 0.25, 0));
  LonePass bare = volumePass("march", underSky(1.0));
  bare.in("opacity", volume.opacity()).in("reflected", volume.reflected());
  CHECK_THROWS_MATCHES(bare.with({{"source", "harmonics"}, {"bounces", 2}}).run(), Error,
                       Tells("bounces", "attributes"));
  // Every further grid must be that of the others.
  CHECK_THROWS_MATCHES(marching(volume, {}).in("attributes", other.attributes()).run(), Error,
                       Tells("attributes", "4 x 4 x 5", "reflected", "4 x 4 x 4"));
  CHECK_THROWS_MATCHES(marching(volume, {{"walk", "exact"}}).in("bits", other.bits()).run(), Error,
                       Tells("bits", "4 x 4 x 5", "opacity", "4 x 4 x 4"));
  for (const char* input : {"opacity", "attributes"}) {
    LonePass gather = volumePass("gather", underSky(0.0));
    const bool ofOpacity = std::string(input) == "opacity";
    gather.in("gbuffer", seen({{{2, 2, 2}, {0, 0, 1}}}))
        .in("incoming", volume.reflected())
        .in("visibility", volume.reflected())
        .in("opacity", (ofOpacity ? other : volume).opacity())
        .in("attributes", (ofOpacity ? volume : other).attributes());
    CHECK_THROWS_MATCHES(gather.run(), Error, Tells(input, "4 x 4 x 5", "incoming", "4 x 4 x 4"));
  }
  ShGrid nested = volume.reflected();
  nested.levels.push_back(nested.levels.front());
  CHECK_THROWS_MATCHES(march(nested, {}), Error, Tells(2, "grids"));
  ShGrid part = volume.reflected();
  part.readFor = "'voxels eight', 'filter on' and 'shift 0.5'";
  CHECK_THROWS_MATCHES(gatheredAt(volume, part, {{2, 2, 2}, {0, 0, 1}}), Error,
                       Tells("voxels eight", "voxels six"));
  // Rays may meet any voxel, so that a volume of which some were left out would be dark there.
  CHECK_THROWS_MATCHES(march(part, {}), Error, Tells("reflected", "voxels eight", "cover all"));
}
