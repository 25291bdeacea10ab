// Whether light that goes from bounce to bounce in closed rooms grows: two bands weigh what comes from behind
// negatively, so that nothing guarantees it.
#include <cmath>

#include "lumivox/base/file.h"
#include "support/imperfect_volumes.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::volumes;

namespace {

/// Everything but the inside is wall; a wall's normal is the mean of the ways to the free voxels around it.
Volume roomWhere(const glm::ivec3& size, const std::function<bool(const glm::ivec3&)>& isFree,
                 double albedo) {
  Volume volume(size);
  const auto free = [&](const glm::ivec3& voxel) { return volume.set().inside(voxel) && isFree(voxel); };
  volume.forEach([&](const glm::ivec3& voxel) {
    if (free(voxel)) return;
    glm::dvec3 inwards(0.0);
    for (int i = 0; i < 27; ++i) {
      const glm::ivec3 way = glm::ivec3(i % 3, i / 3 % 3, i / 9) - 1;
      // Across faces alone, and where there are none across edges and corners.
      if (glm::dot(glm::vec3(way), glm::vec3(way)) == 1.0f && free(voxel + way)) inwards += glm::dvec3(way);
    }
    if (inwards == glm::dvec3(0.0))
      for (int i = 0; i < 27; ++i) {
        const glm::ivec3 way = glm::ivec3(i % 3, i / 3 % 3, i / 9) - 1;
        if (free(voxel + way)) inwards += glm::dvec3(way);
      }
    const bool isWall = inwards != glm::dvec3(0.0);
    volume.occupy(voxel, isWall ? glm::normalize(inwards) : glm::dvec3(0, 0, 1), isWall ? 1.0 : 0.0, 0.0,
                  albedo);
  });
  return volume;
}

Volume ball(int inside, double albedo) {
  const glm::vec3 middle(static_cast<float>(inside + 2) / 2.0f);
  const float radius = static_cast<float>(inside) / 2.0f;
  return roomWhere(
      glm::ivec3(inside + 2),
      [=](const glm::ivec3& v) { return glm::distance(glm::vec3(v) + 0.5f, middle) < radius; }, albedo);
}
Volume cube(int inside, double albedo) {
  return roomWhere(
      glm::ivec3(inside + 2),
      [=](const glm::ivec3& v) {
        return glm::all(glm::greaterThan(v, glm::ivec3(0))) &&
               glm::all(glm::lessThan(v, glm::ivec3(inside + 1)));
      },
      albedo);
}
/// Two rooms with a door in the wall between them.
Volume twoRooms(int inside, double albedo) {
  const glm::ivec3 size(2 * inside + 3, inside + 2, inside + 2);
  return roomWhere(
      size,
      [=](const glm::ivec3& v) {
        const bool within =
            glm::all(glm::greaterThan(v, glm::ivec3(0))) && glm::all(glm::lessThan(v, size - 1));
        const bool door = v.y >= inside / 2 && v.y <= inside / 2 + 2 && v.z <= inside / 2;
        return within && (v.x != inside + 1 || door);
      },
      albedo);
}
Volume roomWithBoxes(int inside, double albedo) {
  return roomWhere(
      glm::ivec3(inside + 2),
      [=](const glm::ivec3& v) {
        const bool within = glm::all(glm::greaterThan(v, glm::ivec3(0))) &&
                            glm::all(glm::lessThan(v, glm::ivec3(inside + 1)));
        const int third = inside / 3;
        const bool tall = v.x > third / 2 && v.x <= third + third / 2 && v.y > third && v.y <= 2 * third &&
                          v.z <= 2 * third,
                   low = v.x > 2 * third - 1 && v.x < inside && v.y > 1 && v.y <= third && v.z <= third;
        return within && !tall && !low;
      },
      albedo);
}

/// Sum of what arrives, in the first band.
double arrived(const Volume& room, const Settings& settings, int bounces) {
  LonePass march = marching(room, {{"rays", 64}, {"bounces", bounces}});
  march.with(settings);
  double sum = 0.0;
  const std::vector<float> values =
      march.out<ShGrid>("incoming").levels[0].coefficients[0]->downloadFloats(0);
  room.forEach([&](const glm::ivec3& voxel) {
    if (!room.set().contains(voxel)) sum += values[4 * room.at(voxel)];
  });
  return sum;
}

/// By what the light of a bounce is larger than that of the one before, in the mean of those between two.
double growth(const Volume& room, const Settings& settings, int from = 6, int to = 16) {
  const auto bounce = [&](int number) {
    return arrived(room, settings, number) - arrived(room, settings, number - 1);
  };
  return std::pow(bounce(to) / bounce(from), 1.0 / (to - from));
}

}  // namespace

TEST_CASE("light in closed white rooms does not grow from bounce to bounce") {
  struct Room {
    const char* name;
    Volume volume;
  };
  for (const Room& room : {Room{"cube of 8", cube(8, 1.0)},
                           {"cube of 16", cube(16, 1.0)},
                           {"ball of 10", ball(10, 1.0)},
                           {"ball of 16", ball(16, 1.0)},
                           {"two rooms of 8", twoRooms(8, 1.0)},
                           {"room of 12 with boxes", roomWithBoxes(12, 1.0)}}) {
    const double found = growth(room.volume, {});
    INFO(room.name << ": " << found);
    CHECK(found <= 1.002);
    CHECK(found >= 0.9);
  }
}

TEST_CASE("light in a closed white room of 32 voxels does not grow either") {
  const double found = growth(cube(32, 1.0), {{"rays", 16}}, 3, 7);
  INFO(found);
  CHECK(found <= 1.002);
  CHECK(found >= 0.95);
}

TEST_CASE("light in a closed room of albedo 0.999 does not grow over a thousand bounces", "[.slow]") {
  const Volume room = cube(8, 0.999);
  const double half = arrived(room, {}, 500), all = arrived(room, {}, 1000), one = arrived(room, {}, 1);
  INFO("one bounce " << one << ", 500 " << half << ", 1000 " << all);
  // sum of 0.999^k: 393.6 and 632.3 of one bounce.
  CHECK(half <= 1.002 * 393.6 * one);
  CHECK(all <= 1.002 * 632.3 * one);
  CHECK(all >= 0.8 * 632.3 * one);
}

TEST_CASE("with two bands of what is met light in a small white room grows, unless dark neighbours damp it") {
  // Two voxels off the walls, where all neighbours are free.
  const Settings off{{"source", "harmonics"}, {"shift", 2}};
  const double eight = growth(cube(8, 1.0), off), sixteen = growth(cube(16, 1.0), off);
  INFO("two voxels off, cubes of 8: " << eight << ", of 16: " << sixteen);
  CHECK(eight > 1.02);
  CHECK(eight < 1.05);
  CHECK(sixteen > 1.004);
  CHECK(sixteen < eight);
  // With the printed weights the dark neighbours in the walls take more than that.
  const double printed = growth(cube(8, 1.0), {{"source", "harmonics"}, {"blend", "all"}});
  INFO("occupied neighbours count: " << printed);
  CHECK(printed < 0.97);
  // The sides of surfaces do not grow there either.
  CHECK(growth(cube(8, 1.0), {{"shift", 2}}) <= 1.002);
}

TEST_CASE("the stress battery shows that light grows as published, and does not by the sides of surfaces") {
  const TemporaryDirectory folder;
  const std::string published = readFile(sourceDirectory() / "scenes/reproductions/000_two_bands.pipeline"),
                    word = "source harmonics in";
  const auto cell = [&](const std::string& source) {
    std::string text = published;
    REQUIRE(text.find(word) != std::string::npos);
    text.replace(text.find(word), word.size(), "source " + source + " in");
    folder.write("000_two_bands.pipeline", text);
    return runCommand("lumivox stress --quick --case thousand_iterations --pipeline '" +
                      (folder.path() / "000_two_bands.pipeline").string() + "'")
        .output;
  };
  const auto radius = [](const std::string& said) {
    const std::string before = "spectral radius ";
    const std::size_t at = said.find(before);
    REQUIRE(at != std::string::npos);
    return std::stod(said.substr(at + before.size()));
  };
  const std::string harmonics = cell("harmonics"), surface = cell("surface");
  INFO(harmonics << surface);
  CHECK(harmonics.find("diverges") != std::string::npos);
  CHECK(radius(harmonics) > 1.002);
  CHECK(surface.find("diverges") == std::string::npos);
  CHECK(radius(surface) < 0.999);
}
