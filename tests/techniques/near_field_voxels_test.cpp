// Rays through bits: whichever way the first voxel is found, it is the same one.
#include <cmath>
#include <random>

#include "lumivox/measure/voxel_walk.h"
#include "support/bit_grids.h"
#include "support/passes.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

struct Rays {
  std::vector<glm::vec3> origins, directions;  ///< in voxels
  std::vector<float> reaches;
  void add(const glm::vec3& origin, const glm::vec3& direction, float reach = 1e9f) {
    origins.push_back(origin);
    directions.push_back(direction);
    reaches.push_back(reach);
  }
};

struct Found {
  glm::ivec3 voxel;
  float t, fetches;
};

/// Origins in voxels of the grid, as the hits' ways.
std::vector<Found> probed(const BinaryGrid& bits, const Rays& rays, const char* method,
                          const GridPlacement& placed) {
  BinaryGrid grid = bits;
  grid.grid.low = placed.low;
  grid.grid.voxelSize = placed.voxelSize;
  constexpr int kWidth = 256;
  const int height = (static_cast<int>(rays.origins.size()) + kWidth - 1) / kWidth;
  std::vector<float> origins(static_cast<std::size_t>(4 * kWidth * height), -1.0f), directions(origins);
  for (std::size_t i = 0; i < rays.origins.size(); ++i)
    for (int c = 0; c < 4; ++c) {
      const auto at = 4 * i + static_cast<std::size_t>(c);
      origins[at] =
          placed.voxelSize * (c < 3 ? rays.origins[i][c] : rays.reaches[i]) + (c < 3 ? placed.low[c] : 0.0f);
      directions[at] = c < 3 ? rays.directions[i][c] : 0.0f;
    }
  const auto image = [&](const std::vector<float>& values) {
    return Image{textureOf(pixels(kWidth, height), values)};
  };
  LonePass probe("near_field_voxels.probe", SceneBuilder().scene, {{"method", method}});
  probe.in("bits", grid).in("origins", image(origins)).in("directions", image(directions));
  const std::vector<float> hits = probe.floats("hits"), fetches = probe.floats("fetches");
  std::vector<Found> result;
  for (std::size_t i = 0; i < rays.origins.size(); ++i)
    result.push_back(
        {{static_cast<int>(std::floor(hits[4 * i])), static_cast<int>(std::floor(hits[4 * i + 1])),
          static_cast<int>(std::floor(hits[4 * i + 2]))},
         hits[4 * i + 3] < 0.0f ? -1.0f : hits[4 * i + 3] / placed.voxelSize,
         fetches[4 * i]});
  return result;
}

VoxelSet randomSet(const glm::ivec3& size, double share, unsigned seed) {
  VoxelSet set(size);
  std::mt19937 random(seed);
  std::bernoulli_distribution is(share);
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x)
        if (is(random)) set.insert({x, y, z});
  return set;
}

/// Of every kind: random, from outside, along axes, in planes, along edges, through corners, nearly along an
/// axis, from planes.
Rays allKinds(const glm::ivec3& size, int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f), normal(-1.0f, 1.0f);
  const glm::vec3 side(size);
  const auto place = [&] { return side * glm::vec3(unit(random), unit(random), unit(random)); };
  const auto turn = [&] {
    glm::vec3 direction;
    do direction = {normal(random), normal(random), normal(random)};
    while (glm::dot(direction, direction) > 1.0f || glm::dot(direction, direction) < 1e-4f);
    return glm::normalize(direction);
  };
  Rays rays;
  for (int i = 0; i < count; ++i) {
    const int axis = i / 10 % 3;
    glm::vec3 origin = place(), direction = turn();
    glm::vec3 along(0.0f);
    along[axis] = i % 2 == 0 ? 1.0f : -1.0f;
    switch (i % 10) {
      case 0:
        break;
      case 1:  // from outside, some from far away, where planes are crossed at rounded places
        origin = 0.5f * side - (i % 20 == 1 ? 2.0f : 300.0f) * glm::length(side) * direction +
                 0.4f * (place() - 0.5f * side);
        break;
      case 2:
        direction = along;
        break;
      case 3:  // in a plane of the grid, and sometimes along an edge
        origin[axis] = std::floor(origin[axis]);
        direction[axis] = 0.0f;
        direction = glm::normalize(direction);
        break;
      case 4:
        origin = glm::floor(origin);
        direction = along;
        break;
      case 5:  // through corners
        origin = glm::floor(origin);
        direction = glm::normalize(glm::sign(direction));
        break;
      case 6:  // ties with slopes of powers of two
        origin = glm::floor(origin) + 0.5f;
        direction = glm::sign(direction) * glm::vec3(1.0f, 0.5f, 0.25f);
        break;
      case 7:
        direction = glm::normalize(along + 1e-5f * direction);
        break;
      case 8:
        origin[axis] = along[axis] > 0.0f ? 0.0f : side[axis];
        break;
      default:  // from a side of the grid, through its corners
        origin = side * glm::vec3(i / 10 & 1, i / 20 & 1, i / 40 & 1);
        direction = glm::normalize(0.5f * side - origin + 0.01f * direction);
        break;
    }
    rays.add(origin, direction, i % 7 == 0 ? 0.3f * glm::length(side) : 1e9f);
  }
  return rays;
}

struct Grid {
  glm::ivec3 size;
  double share;
};
const Grid kGrids[] = {{{32, 32, 32}, 0.02}, {{33, 17, 70}, 0.1},     {{128, 128, 128}, 0.0005},
                       {{5, 1, 300}, 0.01},  {{16, 16, 1024}, 0.001}, {{64, 64, 64}, 0.5},
                       {{1, 1, 1}, 1.0}};

/// The same voxels in the same places by every method and on the CPU.
void checkMethodsAgree(const Grid& one, int count) {
  const VoxelSet set = randomSet(one.size, one.share, 7);
  const BinaryGrid grid = gridOf(set);
  const Rays rays = allKinds(one.size, count, 11);
  int hits = 0;
  std::vector<VoxelHit> expected;
  for (std::size_t i = 0; i < rays.origins.size(); ++i) {
    const auto hit = firstVoxel(set, rays.origins[i], rays.directions[i], rays.reaches[i]);
    hits += hit.has_value();
    expected.push_back(hit.value_or(VoxelHit{glm::ivec3(-1), -1.0f}));
  }
  REQUIRE(hits > 1000);
  REQUIRE(hits < static_cast<int>(rays.origins.size()));
  for (const char* method : {"hierarchy", "stacks", "plain"}) {
    const std::vector<Found> found = probed(grid, rays, method, {});
    int other = 0;
    std::size_t first = 0;
    for (std::size_t i = 0; i < found.size(); ++i)
      if (found[i].voxel != expected[i].voxel || found[i].t != expected[i].t)
        if (other++ == 0) first = i;
    CAPTURE(one.size.x, one.size.y, one.size.z, method, first, found[first].voxel.x, expected[first].voxel.x,
            found[first].t, expected[first].t);
    CHECK(other == 0);
  }
}

}  // namespace

TEST_CASE("a ray finds the same first voxel through the hierarchy, the stacks and one by one as on the CPU") {
  for (const Grid& one : kGrids) checkMethodsAgree(one, 20000);
}

// Of each kind a hundred thousand; minutes.
TEST_CASE("a million rays find the same first voxel by every method", "[.]") {
  for (const Grid& one : kGrids) checkMethodsAgree(one, 1000000);
}

TEST_CASE("rays of small dyadic numbers find the voxels of exact arithmetic, ties included") {
  // Origins in eighths and slopes of 1, 1/2, 1/4 and 0: in eighths, all crossings are whole numbers, sorted
  // here in full.
  std::mt19937 random(3);
  const auto pick = [&](int low, int high) { return std::uniform_int_distribution<int>(low, high)(random); };
  const glm::ivec3 size(9, 14, 21);
  const VoxelSet set = randomSet(size, 0.06, 9);
  int ties = 0, hits = 0;
  for (int ray = 0; ray < 20000; ++ray) {
    glm::ivec3 origin, inverse;  // in eighths; 1, 2, 4 for slopes of 1, 1/2, 1/4; 0: does not move
    for (int axis = 0; axis < 3; ++axis) {
      origin[axis] = pick(-24, 8 * size[axis] + 24);
      inverse[axis] = pick(0, 3) == 0 ? 0 : (1 << pick(0, 2)) * (pick(0, 1) == 0 ? 1 : -1);
    }
    struct Crossing {
      int t, axis;
      bool operator<(const Crossing& other) const { return t != other.t ? t < other.t : axis < other.axis; }
    };
    std::vector<Crossing> crossings;
    glm::ivec3 cell;
    glm::vec3 start, direction(0.0f);
    for (int axis = 0; axis < 3; ++axis) {
      cell[axis] = (origin[axis] + 800) / 8 - 100;  // rounded down
      start[axis] = static_cast<float>(origin[axis]) / 8.0f;
      if (inverse[axis] == 0) continue;
      direction[axis] = 1.0f / static_cast<float>(inverse[axis]);
      for (int i = 0; i < 40; ++i) {
        const int plane = inverse[axis] > 0 ? cell[axis] + 1 + i : cell[axis] - i;
        crossings.push_back({(8 * plane - origin[axis]) * inverse[axis], axis});
      }
    }
    std::sort(crossings.begin(), crossings.end());
    std::optional<VoxelHit> expected;
    const auto look = [&](int t) {
      const bool inside =
          glm::all(glm::greaterThanEqual(cell, glm::ivec3(0))) && glm::all(glm::lessThan(cell, size));
      if (!expected && inside && set.contains(cell)) expected = VoxelHit{cell, static_cast<float>(t) / 8.0f};
    };
    look(0);
    for (std::size_t i = 0; i < crossings.size() && !expected; ++i) {
      ties += i > 0 && crossings[i].t == crossings[i - 1].t;
      cell[crossings[i].axis] += inverse[crossings[i].axis] > 0 ? 1 : -1;
      look(crossings[i].t);
    }
    const auto found = firstVoxel(set, start, direction);
    CAPTURE(ray, start.x, start.y, start.z, direction.x, direction.y, direction.z);
    REQUIRE(found.has_value() == expected.has_value());
    if (!found) continue;
    ++hits;
    CHECK(found->voxel == expected->voxel);
    CHECK(found->t == expected->t);
  }
  CHECK(hits > 2000);
  CHECK(ties > 2000);
}

namespace {

/// Whether a ray meets the voxel enlarged by so much on every side; made smaller where that is below 0.
bool meetsVoxel(const glm::dvec3& origin, const glm::dvec3& direction, const glm::ivec3& voxel,
                double larger) {
  double enter = 0.0, leave = 1e30;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = voxel[axis] - larger - origin[axis], high = voxel[axis] + 1 + larger - origin[axis];
    if (direction[axis] == 0.0) {
      if (low > 0.0 || high < 0.0) return false;
      continue;
    }
    enter = std::max(enter, std::min(low / direction[axis], high / direction[axis]));
    leave = std::min(leave, std::max(low / direction[axis], high / direction[axis]));
  }
  return enter <= leave;
}

}  // namespace

TEST_CASE("other rays find the voxels of finer arithmetic, but for those that pass an edge closely") {
  int all = 0;
  for (const glm::ivec3& size : {glm::ivec3(32, 32, 32), glm::ivec3(33, 17, 70), glm::ivec3(64, 64, 1024)}) {
    const VoxelSet set = randomSet(size, 0.02, 5);
    const Rays rays = allKinds(size, 800000, 21);
    const double side = std::max({size.x, size.y, size.z}), close = side / (1 << 18);
    int others = 0, compared = 0;
    for (std::size_t i = 0; i < rays.origins.size(); ++i) {
      if (i % 20 == 11) continue;  // from 300 diagonals away, where crossings are rounded by more than that
      const glm::dvec3 origin(rays.origins[i]), direction(rays.directions[i]);
      std::optional<glm::ivec3> exact;
      for (VoxelWalk<double> walk(origin, direction, size); walk.inside() && !exact; walk.advance())
        if (set.contains(walk.voxel())) exact = walk.voxel();
      const auto found = firstVoxel(set, rays.origins[i], rays.directions[i]);
      ++compared;
      if (found.has_value() == exact.has_value() && (!found || found->voxel == *exact)) continue;
      ++others;
      CAPTURE(i, size.z);
      // What is found is touched within that distance all the same, and one of both hardly more than that.
      if (found) CHECK(meetsVoxel(origin, direction, found->voxel, close));
      CHECK(((found && !meetsVoxel(origin, direction, found->voxel, -close)) ||
             (exact && !meetsVoxel(origin, direction, *exact, -close))));
    }
    CAPTURE(size.z, others, compared);
    CHECK(others < compared / 1000);
    all += others;
  }
  CHECK(all > 0);  // some are, or nothing was tested
}

TEST_CASE(
    "a ray that begins in a set voxel ends there, and one from a plane in the voxel that holds the plane") {
  VoxelSet set({8, 8, 8});
  set.insert({3, 4, 5});
  Rays rays;
  rays.add({3.5f, 4.5f, 5.5f}, {0, 0, 1});
  rays.add({3.0f, 4.0f, 5.0f}, {-1, 0, 0});  // the lower planes belong to the voxel
  rays.add({4.0f, 4.5f, 5.5f}, {-1, 0, 0});  // the upper ones do not
  rays.add({4.0f, 4.5f, 5.5f}, {1, 0, 0});
  rays.add({-2.0f, 4.5f, 5.5f}, {1, 0, 0}, 4.5f);
  rays.add({-2.0f, 4.5f, 5.5f}, {1, 0, 0}, 5.0f);
  const float way[] = {0, 0, 0, -1, -1, 5, 0};
  rays.add({3.5f, 4.5f, 5.5f}, {0, 0, 1}, 0.0f);
  // Also where voxels are a quarter of a metre, and begin elsewhere: in numbers that are exact.
  for (const GridPlacement& placed : {GridPlacement{}, {glm::vec3(-4, 8, 2), 0.25f, {}}})
    for (const char* method : {"hierarchy", "stacks", "plain"}) {
      const std::vector<Found> found = probed(gridOf(set), rays, method, placed);
      for (std::size_t i = 0; i < found.size(); ++i) {
        CAPTURE(method, i);
        CHECK(found[i].t == way[i]);
        CHECK(found[i].voxel == (way[i] < 0 ? glm::ivec3(-1) : glm::ivec3(3, 4, 5)));
      }
    }
}

TEST_CASE("of every step one texel is read, and of one that begins in a set voxel the first alone") {
  VoxelSet set({8, 8, 8});
  set.insert({6, 4, 5});
  Rays rays;
  rays.add({1.5f, 4.5f, 5.5f}, {1, 0, 0});
  rays.add({6.5f, 4.5f, 5.5f}, {1, 0, 0});
  rays.add({-3.0f, -4.0f, 5.5f}, {-1, 0, 0});
  const std::vector<Found> plain = probed(gridOf(set), rays, "plain", {}),
                           stacks = probed(gridOf(set), rays, "stacks", {});
  const float read[] = {6, 1, 0};
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(plain[i].fetches == read[i]);
    CHECK(stacks[i].fetches == read[i]);
  }
}
