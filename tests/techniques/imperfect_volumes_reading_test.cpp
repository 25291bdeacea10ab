// How surfaces read the volume, against the same written anew on the host; and what is marked for them.
#include "support/imperfect_volumes_reading.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "lumivox/measure/voxel_walk.h"
#include "support/imperfect_volumes.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::volumes;

namespace {

glm::dvec3 someDirection(std::mt19937& random) {
  std::uniform_real_distribution<double> unit;
  const double z = 2.0 * unit(random) - 1.0, angle = 2.0 * kPi * unit(random), sine = std::sqrt(1.0 - z * z);
  return {sine * std::cos(angle), sine * std::sin(angle), z};
}

/// Voxels of any normals, or of none, as walls, sheets and alone.
struct Clutter {
  Volume volume{glm::ivec3(14, 12, 11)};
  std::vector<float> normals;
  explicit Clutter(unsigned seed) : normals(4 * volume.grid().voxelCount()) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit;
    volume.forEach([&](const glm::ivec3& voxel) {
      const bool wall = voxel.z <= 1 || voxel.x == 5 || voxel.x + voxel.y == 18;
      if (!wall && unit(random) > 0.15) return;
      const bool none = unit(random) < 0.4;
      // A tenth as long, as means of many are; where they cancel out, ways are equal.
      const glm::dvec3 normal = none ? glm::dvec3(0.0) : 0.1 * someDirection(random);
      volume.occupy(voxel, normal);
    });
    normals = volume.attributes().normal->downloadFloats(0);
  }
};

/// Any light, of which two bands are nowhere negative; the same in all channels.
struct AnyLight {
  ShGrid grid;
  std::vector<float> values;
  AnyLight(const Volume& volume, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit;
    volume.forEach([&](const glm::ivec3&) {
      values.push_back(5.0f + 20.0f * unit(random));
      for (int c = 0; c < 3; ++c) values.push_back(3.0f * unit(random) - 1.5f);
    });
    grid.quantity = ShGrid::Quantity::radiance;
    const gpu::TextureRef texture = volumeTexture(volume.size(), gpu::Format::rgba32f, values);
    grid.levels.push_back({volume.grid(), {texture, texture, texture}});
  }
};

/// Within the volume: on all sides of all kinds of voxels, of normals of all kinds.
std::vector<ReadPoint> somePoints(const Volume& volume, int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit;
  std::vector<ReadPoint> points;
  for (int i = 0; i < count; ++i) {
    const glm::dvec3 place = glm::dvec3(volume.size()) * glm::dvec3(unit(random), unit(random), unit(random));
    glm::dvec3 normal = someDirection(random);
    // Along axes and diagonals too, where ways are equal.
    if (i % 3 == 0) normal = glm::normalize(glm::round(normal));
    points.push_back({place, normal});
  }
  return points;
}

double expectedAt(const ReadingOnHost& reading, const Volume& volume, const AnyLight& light,
                  const ReadPoint& point, const glm::dvec3& shading) {
  double sum = 0.0;
  for (const auto& [voxel, weight] : reading.sharesAt(point.place, point.normal)) {
    const std::size_t i = 4 * volume.at(voxel);
    sum +=
        weight *
        irradiance({light.values[i], light.values[i + 1], light.values[i + 2], light.values[i + 3]}, shading);
  }
  return sum / kPi;
}

}  // namespace

TEST_CASE("a surface point reads the voxels of Eq. 5 that are free and open to it, with their weights") {
  for (const unsigned seed : {1u, 2u}) {
    const Clutter clutter(seed);
    const AnyLight light(clutter.volume, seed);
    const std::vector<ReadPoint> points = somePoints(clutter.volume, 2000, seed);
    for (const bool six : {true, false})
      for (const bool filtered : {true, false})
        for (const bool free : {true, false})
          for (const double shift : {0.5, 0.8}) {
            const ReadingOnHost reading(clutter.volume.set(), clutter.normals,
                                        {.six = six, .filtered = filtered, .free = free, .shift = shift});
            const std::vector<double> found = gathered(clutter.volume, light.grid, points,
                                                       {{"voxels", six ? "six" : "eight"},
                                                        {"filter", filtered ? "on" : "off"},
                                                        {"blend", free ? "free" : "all"},
                                                        {"shift", shift}});
            int wrong = 0;
            for (std::size_t i = 0; i < points.size(); ++i)
              wrong += std::abs(found[i] /
                                    expectedAt(reading, clutter.volume, light, points[i], points[i].normal) -
                                1.0) > 1e-4;
            CAPTURE(seed, six, filtered, free, shift, wrong);
            // Places on the border between two voxels, and cosines of 0 that round to something, alone.
            CHECK(wrong <= 2);
          }
  }
}

TEST_CASE("triangles decide what is read, and shading normals what of it arrives") {
  const Clutter clutter(3);
  const AnyLight light(clutter.volume, 3);
  const std::vector<ReadPoint> points = somePoints(clutter.volume, 500, 3);
  std::mt19937 random(3);
  std::vector<ReadPoint> shaded = points;
  for (ReadPoint& point : shaded) point.normal = someDirection(random);
  GBuffer both = seen(points);
  both.normal = seen(shaded).normal;
  LonePass gather = volumePass("gather", underSky(0.0), static_cast<int>(points.size()));
  gather.in("gbuffer", both)
      .in("incoming", light.grid)
      .in("visibility", light.grid)
      .in("opacity", clutter.volume.opacity())
      .in("attributes", clutter.volume.attributes());
  const std::vector<float> found = gather.floats("diffuse");
  const ReadingOnHost reading(clutter.volume.set(), clutter.normals, {});
  int wrong = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    wrong += std::abs(found[4 * i] / expectedAt(reading, clutter.volume, light, points[i], shaded[i].normal) -
                      1.0) > 1e-4;
  CHECK(wrong <= 2);
}

TEST_CASE(
    "what voxels read between two bounces is marked, with and without normals, however far surfaces are shifted") {
  constexpr int kSide = 16;
  Volume volume({kSide, kSide, kSide});
  std::mt19937 random(4);
  std::uniform_real_distribution<double> unit;
  volume.forEach([&](const glm::ivec3& voxel) {
    const bool border =
        glm::any(glm::equal(voxel, glm::ivec3(0))) || glm::any(glm::equal(voxel, glm::ivec3(kSide - 1)));
    if (border || unit(random) < 0.02)
      volume.occupy(voxel, someDirection(random), unit(random), unit(random), 0.8);
  });
  // Both sides may cancel out, so that the light decides which way a surface looks.
  AttributeGrid cancelled = volume.attributes();
  cancelled.normal->clear(glm::vec4(0.0f));
  const std::vector<ReadPoint> points{{{8.2f, 7.7f, 8.4f}, {0, 0, 1}}};
  for (const AttributeGrid& attributes : {cancelled, volume.attributes()})
    for (const double shift : {0.5, 3.0})
      for (const char* voxels : {"six", "eight"}) {
        const Settings reads{{"shift", shift}, {"voxels", voxels}};
        LonePass march = marching(volume, {{"rays", 64}, {"bounces", 2}});
        march.with(reads).in("attributes", attributes).in("gbuffer", seen(points));
        const std::vector<double> part = gathered(volume, march.out<ShGrid>("incoming"), points, reads);
        march.with({{"cover", "all"}});
        CAPTURE(shift, voxels);
        CHECK(part == gathered(volume, march.out<ShGrid>("incoming"), points, reads));
      }
}

TEST_CASE("a voxel that nothing tells which way it looks passes on what arrives from all sides") {
  // Under an even sky, and without a normal: as bright on both sides as its albedo makes of the sky.
  Volume volume({9, 9, 9});
  volume.occupy({4, 4, 4}, {0, 0, 1}, 0.0, 0.0, 0.5);
  AttributeGrid attributes = volume.attributes();
  attributes.normal->clear(glm::vec4(0.0f));
  const auto arrivingWith = [&](double bounces) {
    LonePass march = marching(volume, {{"rays", 4000}, {"bounces", bounces}, {"walk", "exact"}}, 2.0);
    march.in("attributes", attributes);
    return coefficientsIn(march.out<ShGrid>("incoming"), {4, 4, 7}).x;
  };
  // Of the sky the voxel takes away as much as it sends, but for its albedo.
  const double hidden = constant(2.0).x - arrivingWith(1), sent = arrivingWith(2) - arrivingWith(1);
  CHECK(hidden > 0.0);
  CHECK(sent == Approx(0.5 * hidden).epsilon(0.05));
}

TEST_CASE("the sky is seen once, however often light is reflected") {
  const Volume empty({6, 6, 6});
  for (const double bounces : {1.0, 3.0})
    CHECK(coefficientsIn(arriving(empty, {{"bounces", bounces}}, 2.0), {3, 3, 3}).x ==
          Approx(double{constant(2.0).x}).epsilon(1e-5));
}

TEST_CASE("a voxel passes on what arrives on both of its sides, each into its own half space") {
  // A sheet between a wall that shines 1 and one that shines 3: of its albedo so much goes back to each.
  constexpr int kSide = 24, kSheet = 6, kLast = 12;
  Volume volume({kSide, kSide, kLast + 1});
  const auto along = [](double z) { return [=](const glm::ivec3&) { return glm::dvec3(0, 0, z); }; };
  const auto at = [](int z) { return [=](const glm::ivec3& voxel) { return voxel.z == z; }; };
  volume.occupyWhere(at(0), along(1), 1.0, 0.0, 0.0)
      .occupyWhere(at(kSheet), along(1), 0.0, 0.0, 0.5)
      .occupyWhere(at(kLast), along(-1), 3.0, 0.0, 0.0);
  const glm::ivec3 below(kSide / 2, kSide / 2, kSheet - 2), above(kSide / 2, kSide / 2, kSheet + 2);
  for (const char* feed : {"front", "own"}) {
    const auto second = [&](const glm::ivec3& voxel, double bounces) {
      return coefficientsIn(arriving(volume, {{"rays", 64}, {"bounces", bounces}, {"feed", feed}}), voxel);
    };
    // What the second bounce adds comes from the sheet alone: from all directions that meet it.
    const glm::dvec4 fromBelow = second(below, 2) - second(below, 1),
                     fromAbove = second(above, 2) - second(above, 1);
    CAPTURE(feed, fromBelow.x, fromBelow.z, fromAbove.x, fromAbove.z);
    CHECK(fromBelow.z > 0.0);
    CHECK(fromAbove.z < 0.0);
    // The upper wall is three times as bright.
    CHECK(fromAbove.x > 2.0 * fromBelow.x);
    if (std::string(feed) == "front") CHECK(fromAbove.x == Approx(3.0 * fromBelow.x).epsilon(0.1));
  }
}

TEST_CASE(
    "as printed the buffers alternate: a black room passes on all of its light, and the last pass is all there is") {
  constexpr int kSide = 12;
  const auto middle = [&](const char* feed, double bounces, double albedo, double sky) {
    Volume volume({kSide, kSide, kSide});
    // Walls that shine 2 to all sides; with a sky through a hole in the roof.
    const auto wall = [&](const glm::ivec3& voxel) {
      const bool hole = sky > 0.0 && voxel.y == kSide - 1 && voxel.x > 3 && voxel.x < 8;
      return !hole && (glm::any(glm::equal(voxel, glm::ivec3(0))) ||
                       glm::any(glm::equal(voxel, glm::ivec3(kSide - 1))));
    };
    volume.occupyWhere(
        wall, [](const glm::ivec3&) { return glm::dvec3(0, 1, 0); }, 2.0, 2.0, albedo);
    return coefficientsIn(
               arriving(volume,
                        {{"rays", 256}, {"bounces", bounces}, {"source", "harmonics"}, {"feed", feed}}, sky),
               glm::ivec3(kSide / 2))
        .x;
  };
  const double first = middle("printed", 1, 0.0, 0.0);
  CHECK(first == Approx(middle("own", 1, 0.0, 0.0)).epsilon(1e-6));
  CHECK(middle("own", 3, 0.0, 0.0) == Approx(first).epsilon(1e-6));  // nothing is reflected again
  for (const double bounces : {2.0, 3.0}) {
    const double printed = middle("printed", bounces, 0.0, 0.0);
    CAPTURE(bounces, first, printed);
    CHECK(printed == Approx(middle("printed", bounces, 0.7, 0.0)).epsilon(1e-6));
    CHECK(printed > 0.5 * first);  // in place of nothing
    CHECK(printed < 1.5 * first);  // and not the sum of the passes, each of which is at least half of it
  }
  // A pass that replaces the one before sees the sky itself.
  CHECK(middle("printed", 2, 0.0, 50.0) > 2.0 * middle("printed", 2, 0.0, 1e-3));
}

TEST_CASE(
    "what leaves a voxel again is albedo / pi of what arrives on the side that is seen, voxel by voxel") {
  Clutter clutter(5);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit;
  std::vector<double> albedo(clutter.volume.grid().voxelCount());
  clutter.volume.forEach([&](const glm::ivec3& voxel) {
    if (!clutter.volume.set().contains(voxel)) return;
    const std::size_t i = clutter.volume.at(voxel);
    const glm::dvec3 normal(clutter.normals[4 * i], clutter.normals[4 * i + 1], clutter.normals[4 * i + 2]);
    albedo[i] = 0.25 * static_cast<double>(1 + random() % 3);
    clutter.volume.occupy(voxel, normal, 1.0 + 20.0 * (voxel.x % 4 == 1 ? 1.0 : 0.0), 2.0, albedo[i]);
  });
  const VoxelSet& set = clutter.volume.set();
  for (const char* feed : {"front", "own"}) {
    const auto light = [&](double bounces) {
      return arriving(clutter.volume,
                      {{"rays", 1024}, {"walk", "exact"}, {"bounces", bounces}, {"feed", feed}}, 0.5)
          .levels[0]
          .coefficients[1]
          ->downloadFloats(0);
    };
    const std::vector<float> first = light(1), both = light(2);
    const auto arrivedIn = [&](const glm::ivec3& voxel) {
      const std::size_t i = 4 * clutter.volume.at(voxel);
      return glm::dvec4(first[i], first[i + 1], first[i + 2], first[i + 3]);
    };
    // Radiance of both sides of each voxel, and the direction of the first.
    const ReadingOnHost reading(set, clutter.normals, {});
    std::vector<std::array<double, 2>> sent(albedo.size());
    std::vector<glm::dvec3> looks(albedo.size());
    clutter.volume.forEach([&](const glm::ivec3& voxel) {
      const std::size_t i = clutter.volume.at(voxel);
      glm::dvec3& normal = looks[i];
      normal = {clutter.normals[4 * i], clutter.normals[4 * i + 1], clutter.normals[4 * i + 2]};
      const glm::dvec4 own = arrivedIn(voxel);
      normal = glm::normalize(glm::length(normal) > 1.0 / 64.0 ? normal : glm::dvec3(own.w, own.y, own.z));
      for (const std::size_t side : {0u, 1u}) {
        const glm::dvec3 outwards = side == 0 ? normal : -normal;
        glm::dvec4 sum = own;
        if (std::string(feed) == "front") {
          sum = glm::dvec4(0.0);
          for (const auto& [from, weight] : reading.sharesAt(glm::dvec3(voxel) + 0.5, outwards))
            sum += weight * arrivedIn(from);
        }
        sent[i][side] = albedo[i] / kPi * std::max(irradiance(sum, outwards), 0.0);
      }
    });
    double apart = 0.0, all = 0.0, ratio = 0.0, expectedSum = 0.0;
    clutter.volume.forEach([&](const glm::ivec3& voxel) {
      if ((voxel.x + voxel.y + voxel.z) % 4 != 0) return;
      constexpr int kStrata = 24;
      glm::dvec4 expected(0.0);
      for (int i = 0; i < kStrata; ++i)
        for (int j = 0; j < 2 * kStrata; ++j) {
          const double z = 2.0 * (i + unit(random)) / kStrata - 1.0,
                       angle = kPi * (j + unit(random)) / kStrata,
                       sine = std::sqrt(std::max(1.0 - z * z, 0.0));
          const glm::dvec3 way(sine * std::cos(angle), sine * std::sin(angle), z);
          const auto hit =
              firstVoxel(set, glm::vec3(voxel) + 0.5f + 0.8660255f * glm::vec3(way), glm::vec3(way));
          if (!hit) continue;
          const std::size_t k = clutter.volume.at(hit->voxel);
          const double radiance = sent[k][glm::dot(looks[k], way) <= 0.0 ? 0 : 1];
          expected += 4.0 * kPi / (2.0 * kStrata * kStrata) * radiance *
                      glm::dvec4(kY0, kY1 * way.y, kY1 * way.z, kY1 * way.x);
        }
      const std::size_t i = 4 * clutter.volume.at(voxel);
      for (int c = 0; c < 4; ++c) {
        const auto k = i + static_cast<std::size_t>(c);
        const double found = double{both[k]} - double{first[k]};
        apart += (found - expected[c]) * (found - expected[c]);
        all += expected[c] * expected[c];
      }
      ratio += double{both[i]} - double{first[i]};
      expectedSum += expected.x;
    });
    CAPTURE(feed, std::sqrt(apart / all), ratio / expectedSum);
    CHECK(std::sqrt(apart / all) < 0.035);
    CHECK(ratio == Approx(expectedSum).epsilon(0.002));
  }
}

TEST_CASE(
    "a voxel is occupied from a coverage above 'occupied' on, for rays, for surfaces and between bounces") {
  Volume volume({10, 10, 10});
  volume.occupyWhere([](const glm::ivec3& voxel) { return voxel.z == 5; },
                     [](const glm::ivec3&) { return glm::dvec3(0, 0, 1); }, 1.0, 1.0);
  OccupancyGrid half = volume.opacity();
  half.opacity = volumeTexture(volume.size(), gpu::Format::r8, std::vector<float>(1000, 0.4f));
  std::vector<float> values(1000, 0.0f);
  for (std::size_t i = 500; i < 600; ++i) values[i] = 0.4f;
  half.opacity->uploadFloats(0, values);
  const auto arrivingWith = [&](double occupied, double bounces) {
    LonePass march = marching(volume, {{"occupied", occupied}, {"bounces", bounces}, {"rays", 64}}, 0.5);
    march.in("opacity", half);
    return coefficientsIn(march.out<ShGrid>("incoming"), {4, 4, 2}).x;
  };
  CHECK(arrivingWith(0.5, 2) == Approx(double{constant(0.5).x}).epsilon(1e-5));
  CHECK(arrivingWith(0.3, 1) > 1.1 * constant(0.5).x);
  CHECK(arrivingWith(0.3, 2) > 1.05 * arrivingWith(0.3, 1));
  // Between bounces nothing is read of its own voxel where that is occupied.
  const AnyLight light(volume, 7);
  const auto readWith = [&](double occupied, const OccupancyGrid& opacity) {
    LonePass gather = volumePass("gather", underSky(0.0));
    gather.in("gbuffer", seen({{{4.3f, 4.6f, 5.4f}, {0, 0, 1}}}))
        .in("incoming", light.grid)
        .in("visibility", light.grid)
        .in("opacity", opacity)
        .in("attributes", volume.attributes())
        .with({{"occupied", occupied}});
    return gather.floats("diffuse").front();
  };
  CHECK(readWith(0.3, half) == readWith(0.0, volume.opacity()));
  CHECK(readWith(0.5, half) == readWith(0.0, Volume(volume.size()).opacity()));
  CHECK(readWith(0.3, half) != readWith(0.5, half));
}

TEST_CASE("outside of the volume a surface sees the environment alone, and nothing is closed or cut off") {
  const Volume volume({4, 4, 4});
  const AnyLight light(volume, 8);
  const std::vector<ReadPoint> points{{{4.5f, 2.0f, 2.0f}, {0, 0, 1}}, {{2.0f, -0.5f, 2.0f}, {0, 1, 0}}};
  for (const auto& [output, expected] :
       {std::pair("diffuse", 1.5), std::pair("clipped", 0.0), std::pair("occlusion", 1.0)}) {
    INFO(output);
    CHECK(gathered(volume, light.grid, points, {}, 1.5, output) == std::vector<double>(2, expected));
  }
}

TEST_CASE("numbers of a volume count its unit, for rays and for surfaces") {
  const Volume room = closedRoom(6, 1.0);
  ShGrid reflected = room.reflected();
  const auto sum = [&](double unit) {
    reflected.unit = static_cast<float>(unit);
    LonePass march = marching(room, {{"rays", 50}});
    march.in("reflected", reflected);
    return march.out<ShGrid>("incoming");
  };
  CHECK(coefficientsIn(sum(0.25), {3, 3, 3}).x == Approx(0.25 * coefficientsIn(sum(1.0), {3, 3, 3}).x));
  ShGrid light = sum(1.0);
  const ReadPoint wall{{0.9f, 3.5f, 3.5f}, {1, 0, 0}};
  const double one = gatheredAt(room, light, wall);
  light.unit = 3.0f;
  CHECK(gatheredAt(room, light, wall) == Approx(3.0 * one));
  light.unit = 0.25f;
  CHECK(gatheredAt(room, light, wall, {}, "occlusion") == Approx(0.25 * one));
}

TEST_CASE("colours keep apart where they are read and where they are passed on") {
  const Volume empty({5, 5, 5});
  const ShGrid light = evenLight(empty, [](const glm::ivec3&, int c) { return 1.0 + c; });
  for (const auto& [voxels, blend] : {std::pair("six", "free"), std::pair("eight", "all")}) {
    LonePass gather = volumePass("gather", underSky(0.0));
    gather.in("gbuffer", seen({{{2.2f, 2.4f, 2.7f}, {0, 0, 1}}}))
        .in("incoming", light)
        .in("visibility", light)
        .in("opacity", empty.opacity())
        .in("attributes", empty.attributes())
        .with({{"voxels", voxels}, {"blend", blend}});
    const std::vector<float> found = gather.floats("diffuse");
    for (std::size_t c = 0; c < 3; ++c) CHECK(found[c] == Approx(1.0 + static_cast<double>(c)).epsilon(1e-5));
  }
  // Walls that reflect 0.8 of red, 0.4 of green and 0.2 of blue, between two bounces.
  const Volume room = closedRoom(6, 1.0);
  AttributeGrid attributes = room.attributes();
  std::vector<float> albedo;
  room.forEach([&](const glm::ivec3&) { albedo.insert(albedo.end(), {0.8f, 0.4f, 0.2f, 1.0f}); });
  attributes.albedo = volumeTexture(room.size(), gpu::Format::rgba16f, albedo);
  const auto total = [&](double bounces, std::size_t channel) {
    LonePass march = marching(room, {{"rays", 50}, {"bounces", bounces}});
    march.in("attributes", attributes);
    const std::vector<float> values =
        march.out<ShGrid>("incoming").levels[0].coefficients[channel]->downloadFloats(0);
    return double{values[4 * room.at({3, 3, 3})]};
  };
  for (std::size_t c = 0; c < 3; ++c)
    CHECK(total(2, c) / total(1, c) == Approx(1.0 + albedo[c]).epsilon(0.01));
}
