// Ray by ray: what `march` finds on each of its rays, told from the coefficients of one pair of them, against
// a walk of the host through the same voxels.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <random>

#include "lumivox/measure/voxel_walk.h"
#include "support/imperfect_volumes.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::volumes;

namespace {

/// The technique's own default.
constexpr float kGuard = 0.8660255f;

/// Where voxels send their own place on both sides: in red, green and blue one more than x, y and z, or than
/// what is left of them by `modulus`.
ShGrid places(const glm::ivec3& size, int modulus = 1 << 20) {
  return evenLight(Volume(size), [=](const glm::ivec3& voxel, int c) { return voxel[c] % modulus + 1.0; });
}

/// The two opposite rays of a voxel: its direction, and what each of them found; 0 where it met nothing.
struct Pair {
  glm::dvec3 direction;
  std::array<glm::dvec3, 2> found;
};

/// What `march` found on two rays of every voxel. Of a pair the coefficients are 2 pi times the sum of both
/// in the first band, and times their difference along the direction in the second: which way it goes is
/// told by `whereAll_`, in which all voxels are occupied, so that both rays meet another one at once (in
/// small numbers, which leave the direction all of its bits). Voxels at the border have rays that meet
/// nothing.
class Pairs {
 public:
  Pairs(const Volume& volume, const Settings& settings, std::uint64_t seed = 1)
      : size_(volume.size()), found_(marched(volume, settings, seed, 1 << 20)) {
    Volume full(size_);
    full.occupyWhere([](const glm::ivec3&) { return true; },
                     [](const glm::ivec3&) { return glm::dvec3(0, 0, 1); }, 0.0);
    Settings ofWays;
    for (const Setting& one : settings)
      if (one.name() == "directions") ofWays.push_back(one);
    whereAll_ = marched(full, ofWays, seed, 4);
  }

  Pair of(const glm::ivec3& voxel) const {
    const std::size_t i = 4 * static_cast<std::size_t>((voxel.z * size_.y + voxel.y) * size_.x + voxel.x);
    glm::dvec3 longest(0.0);
    for (const auto& channel : whereAll_) {
      const glm::dvec3 band(channel[i + 3], channel[i + 1], channel[i + 2]);
      if (glm::length(band) > glm::length(longest)) longest = band;
    }
    REQUIRE(glm::length(longest) > 1.0);
    Pair pair{glm::normalize(longest.z < 0.0 ? -longest : longest), {}};
    for (int c = 0; c < 3; ++c) {
      const auto& channel = found_[static_cast<std::size_t>(c)];
      const double sum = channel[i] / (2.0 * kPi * kY0),
                   difference =
                       glm::dot(glm::dvec3(channel[i + 3], channel[i + 1], channel[i + 2]), pair.direction) /
                       (2.0 * kPi * kY1);
      pair.found[0][c] = 0.5 * (sum + difference);
      pair.found[1][c] = 0.5 * (sum - difference);
    }
    return pair;
  }

 private:
  glm::ivec3 size_;
  std::array<std::vector<float>, 3> found_, whereAll_;

  static std::array<std::vector<float>, 3> marched(const Volume& volume, Settings settings,
                                                   std::uint64_t seed, int modulus) {
    settings.push_back({"rays", 2});
    LonePass march = marching(volume, settings);
    march.in("reflected", places(volume.size(), modulus));
    const ShGrid light = march.run(seed).out<ShGrid>("incoming");
    std::array<std::vector<float>, 3> result;
    for (std::size_t c = 0; c < 3; ++c) result[c] = light.levels[0].coefficients[c]->downloadFloats(0);
    return result;
  }
};

/// Some voxels in open air, a wall, and a slanted sheet.
Volume scattered(const glm::ivec3& size, double share, unsigned seed) {
  Volume volume(size);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit;
  const auto up = [](const glm::ivec3&) { return glm::dvec3(0, 0, 1); };
  return volume.occupyWhere(
      [&](const glm::ivec3& voxel) {
        return unit(random) < share || (voxel.x == 2 && voxel.y > size.y / 2) ||
               voxel.y + voxel.z == size.y + 3;
      },
      up, 0.0);
}

/// Directions that a ray may have had: told from single precision, it is right to some 10^-6.
std::vector<glm::dvec3> nearby(const glm::dvec3& direction) {
  std::vector<glm::dvec3> result{direction};
  for (const double far : {1e-6, 5e-6})
    for (int i = 0; i < 27; ++i)
      result.push_back(glm::normalize(direction + far * (glm::dvec3(i % 3, i / 3 % 3, i / 9) - 1.0)));
  return result;
}

/// Those that no ray leaves at once.
template <class Work>
void forEachInside(const Volume& volume, const Work& work) {
  volume.forEach([&](const glm::ivec3& voxel) {
    if (glm::all(glm::greaterThan(voxel, glm::ivec3(0))) && glm::all(glm::lessThan(voxel, volume.size() - 1)))
      work(voxel);
  });
}

/// How many rays found what the host finds by `expected`, and how many only along a direction beside theirs.
struct Compared {
  int rays = 0, met = 0, byNeighbour = 0, wrong = 0;
};
template <class Expected>
Compared compared(const Volume& volume, const Pairs& pairs, const Expected& expected) {
  Compared result;
  forEachInside(volume, [&](const glm::ivec3& voxel) {
    const Pair pair = pairs.of(voxel);
    for (int side = 0; side < 2; ++side) {
      const glm::dvec3 found = pair.found[static_cast<std::size_t>(side)];
      const std::vector<glm::dvec3> ways = nearby(side == 0 ? pair.direction : -pair.direction);
      const auto agrees = [&](const glm::dvec3& way) {
        return glm::length(expected(voxel, way) - found) < 2e-3;
      };
      ++result.rays;
      result.met += glm::length(found) > 0.5;
      if (agrees(ways.front())) continue;
      ++(std::any_of(ways.begin(), ways.end(), agrees) ? result.byNeighbour : result.wrong);
    }
  });
  return result;
}

glm::dvec3 placeOf(const glm::ivec3& voxel) {
  return glm::dvec3(voxel) + 1.0;
}

/// The first place at a step of a ray that is occupied.
template <class IsOccupied>
std::optional<glm::dvec3> firstStep(const glm::ivec3& size, const glm::ivec3& voxel, const glm::dvec3& way,
                                    double step, const IsOccupied& isOccupied) {
  for (int i = 0;; ++i) {
    const glm::dvec3 place = glm::dvec3(voxel) + 0.5 + (kGuard + i * step) * way;
    if (glm::any(glm::lessThan(place, glm::dvec3(0.0))) ||
        glm::any(glm::greaterThanEqual(place, glm::dvec3(size))))
      return std::nullopt;
    if (isOccupied(place)) return place;
  }
}

/// The occupied voxels of the eight around a place, with their trilinear weights.
std::vector<std::pair<glm::ivec3, double>> occupiedAround(const VoxelSet& set, const glm::dvec3& place) {
  std::vector<std::pair<glm::ivec3, double>> result;
  const glm::dvec3 low = glm::floor(place - 0.5), part = place - 0.5 - low;
  for (int i = 0; i < 8; ++i) {
    const glm::ivec3 high(i & 1, i >> 1 & 1, i >> 2),
        voxel = glm::clamp(glm::ivec3(low) + high, glm::ivec3(0), set.resolution() - 1);
    double weight = 1.0;
    for (int axis = 0; axis < 3; ++axis) weight *= high[axis] == 1 ? part[axis] : 1.0 - part[axis];
    if (set.contains(voxel)) result.emplace_back(voxel, weight);
  }
  return result;
}

}  // namespace

TEST_CASE("every ray of 'walk exact' finds the voxel of the walk on the host") {
  for (const glm::ivec3& size : {glm::ivec3(24), glm::ivec3(20, 33, 9)})
    for (const double share : {0.005, 0.1}) {
      const Volume volume = scattered(size, share, 3);
      const Compared all = compared(
          volume, Pairs(volume, {{"walk", "exact"}}), [&](const glm::ivec3& voxel, const glm::dvec3& way) {
            const glm::vec3 direction(way);
            const auto hit =
                firstVoxel(volume.set(), glm::vec3(voxel) + 0.5f + kGuard * direction, direction);
            return hit ? placeOf(hit->voxel) : glm::dvec3(0.0);
          });
      CAPTURE(share, all.rays, all.met, all.byNeighbour);
      CHECK(all.wrong == 0);
      CHECK(all.byNeighbour < all.rays / 1000);
      CHECK(all.met > all.rays / 5);
      CHECK(all.met < all.rays);
    }
}

TEST_CASE("every ray of 'walk steps' finds what stands at its first occupied step on the host") {
  const glm::ivec3 size(24, 20, 17);
  const Volume volume = scattered(size, 0.02, 4);
  for (const double step : {1.0, 0.3, 2.5})
    for (const char* exit : {"early", "branchless"}) {
      const Compared all = compared(volume, Pairs(volume, {{"step", step}, {"exit", exit}}),
                                    [&](const glm::ivec3& voxel, const glm::dvec3& way) {
                                      const auto place =
                                          firstStep(size, voxel, way, step, [&](const glm::dvec3& at) {
                                            return volume.set().contains(glm::ivec3(at));
                                          });
                                      return place ? placeOf(glm::ivec3(*place)) : glm::dvec3(0.0);
                                    });
      CAPTURE(step, exit, all.rays, all.met, all.byNeighbour);
      CHECK(all.wrong == 0);
      CHECK(all.byNeighbour < all.rays / 1000);
      CHECK(all.met > all.rays / 5);
    }
}

TEST_CASE(
    "with 'reading linear' a ray meets half of what is interpolated, and takes the mean of what is there") {
  const glm::ivec3 size(16, 14, 15);
  const Volume volume = scattered(size, 0.15, 5);
  const Compared all = compared(
      volume, Pairs(volume, {{"reading", "linear"}}), [&](const glm::ivec3& voxel, const glm::dvec3& way) {
        const auto place = firstStep(size, voxel, way, 1.0, [&](const glm::dvec3& at) {
          double share = 0.0;
          for (const auto& [one, weight] : occupiedAround(volume.set(), at)) share += weight;
          return share >= 0.5;
        });
        glm::dvec3 sum(0.0);
        double weights = 0.0;
        if (place)
          for (const auto& [one, weight] : occupiedAround(volume.set(), *place)) {
            sum += weight * placeOf(one);
            weights += weight;
          }
        return weights > 0.0 ? sum / weights : sum;
      });
  CAPTURE(all.rays, all.met, all.byNeighbour);
  CHECK(all.wrong == 0);
  CHECK(all.byNeighbour < all.rays / 200);
  CHECK(all.met > all.rays / 5);
}

TEST_CASE("rays go to all sides alike, from each voxel by a set of its own, or by one for all") {
  const Volume volume = scattered(glm::ivec3(24), 0.02, 6);
  const auto ways = [&](const char* directions, std::uint64_t seed) {
    const Pairs pairs(volume, {{"directions", directions}}, seed);
    std::vector<glm::dvec3> result;
    forEachInside(volume, [&](const glm::ivec3& voxel) { result.push_back(pairs.of(voxel).direction); });
    return result;
  };
  const std::vector<glm::dvec3> own = ways("voxel", 1), others = ways("voxel", 2), shared = ways("shared", 1);
  const auto count = static_cast<double>(own.size());
  glm::dvec3 first(0.0), second(0.0), mixed(0.0);
  double same = 0.0, spread = 0.0;
  for (std::size_t i = 0; i < own.size(); ++i) {
    first += own[i] / count;
    second += own[i] * own[i] / count;
    mixed += own[i] * glm::dvec3(own[i].y, own[i].z, own[i].x) / count;
    same += glm::dot(own[i], others[i]) / count;
    spread = std::max(spread, glm::distance(shared[i], shared[0]));
  }
  // Of the upper half of a sphere: z is 1/2 in the mean, and all squares are 1/3. Four standard errors.
  const double most = 4.0 * 0.5 / std::sqrt(count);
  CAPTURE(first.x, first.y, first.z, second.x, second.y, second.z, same, spread);
  CHECK(std::abs(first.x) < most);
  CHECK(std::abs(first.y) < most);
  CHECK(std::abs(first.z - 0.5) < most);
  for (int axis = 0; axis < 3; ++axis) {
    CHECK(std::abs(second[axis] - 1.0 / 3.0) < most);
    CHECK(std::abs(mixed[axis]) < most);
  }
  // Another seed has other directions: of two of the upper half the cosine is 1/4 in the mean.
  CHECK(std::abs(same - 0.25) < 2.0 * most);
  CHECK(spread < 1e-5);
}

TEST_CASE("rays are stratified: their noise falls faster than the root of their number") {
  const Volume volume = scattered(glm::ivec3(16), 0.1, 7);
  const auto noise = [&](double rays) {
    double sum = 0.0, squares = 0.0;
    constexpr int kSeeds = 24;
    for (int seed = 1; seed <= kSeeds; ++seed) {
      LonePass march = marching(volume, {{"rays", rays}, {"voxels", "own"}});
      march.in("reflected", places(volume.size())).in("gbuffer", seen({{{8.5f, 8.5f, 8.5f}, {0, 0, 1}}}));
      const double found =
          coefficientsIn(march.run(static_cast<std::uint64_t>(seed)).out<ShGrid>("incoming"), {8, 8, 8}).x;
      sum += found / kSeeds;
      squares += found * found / kSeeds;
    }
    return std::sqrt(squares - sum * sum) / sum;
  };
  const double few = noise(64), many = noise(64 * 64);
  CAPTURE(few, many);
  CHECK(many < few / 16.0);
}

TEST_CASE("openness counts what lies within its distance, by either walk") {
  // Over a wide floor at height h within R: directions whose way to the floor is at most R are a share
  // (1 - h / R) / 2 of all.
  Volume volume({64, 64, 12});
  volume.occupyWhere([](const glm::ivec3& voxel) { return voxel.z == 0; },
                     [](const glm::ivec3&) { return glm::dvec3(0, 0, 1); }, 0.0);
  constexpr double kHeight = 4.5;
  const auto share = [&](const char* walk, double distance, double metres = 1.0) {
    OccupancyGrid opacity = volume.opacity();
    BinaryGrid bits = volume.bits();
    opacity.grid.voxelSize = bits.grid.voxelSize = static_cast<float>(metres);
    LonePass occlude = volumePass("occlude", underSky(0.0));
    occlude.in("opacity", opacity)
        .in("bits", bits)
        .in("gbuffer", seen({{static_cast<float>(metres) * glm::vec3(32.5f, 32.5f, 5.5f), {0, 0, 1}}}))
        .with({{"rays", 20000},
               {"distance", metres * distance},
               {"step", 0.02},
               {"walk", walk},
               {"voxels", "own"}});
    return 1.0 - coefficientsIn(occlude.out<ShGrid>("visibility"), {32, 32, 5}).x / (4.0 * kPi * kY0);
  };
  for (const char* walk : {"steps", "exact"}) {
    INFO(walk);
    CHECK(share(walk, kHeight - 0.01) == Approx(0.0).margin(1e-4));
    for (const double reach : {5.0, 9.0, 18.0})
      CHECK(share(walk, reach) == Approx(0.5 * (1.0 - kHeight / reach)).epsilon(0.03));
    // Metres, however large voxels are.
    CHECK(share(walk, 9.0, 0.25) == share(walk, 9.0));
    // Shorter than the guard: nothing is met.
    CHECK(share(walk, 0.5) == Approx(0.0).margin(1e-4));
  }
}
