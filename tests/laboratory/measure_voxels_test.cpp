// Exact voxels against closed forms and against brute force, and the errors and holes of hand-made grids.
#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <glm/gtc/constants.hpp>
#include <limits>
#include <random>

#include "lumivox/base/error.h"
#include "lumivox/measure/voxels.h"
#include "support/scene_builder.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

std::uint64_t cubed(std::uint64_t n) {
  return n * n * n;
}

void forEachVoxel(const glm::ivec3& resolution, const std::function<void(const glm::ivec3&)>& visit) {
  for (int z = 0; z < resolution.z; ++z)
    for (int y = 0; y < resolution.y; ++y)
      for (int x = 0; x < resolution.x; ++x) visit({x, y, z});
}

/// The two triangles of a parallelogram, in voxels.
std::vector<ExactTriangle> parallelogram(const glm::dvec3& corner, const glm::dvec3& u, const glm::dvec3& v) {
  return {{corner, corner + u, corner + u + v}, {corner, corner + u + v, corner + v}};
}

std::vector<ExactTriangle> boxTriangles(const glm::dvec3& low, const glm::dvec3& high) {
  std::vector<ExactTriangle> triangles;
  const glm::dvec3 size = high - low;
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 u(0), v(0), across(0);
    u[(axis + 1) % 3] = size[(axis + 1) % 3];
    v[(axis + 2) % 3] = size[(axis + 2) % 3];
    across[axis] = size[axis];
    for (const glm::dvec3& corner : {low, low + across})
      for (const ExactTriangle& triangle : parallelogram(corner, u, v)) triangles.push_back(triangle);
  }
  return triangles;
}

/// Latitude and longitude, `rows` times twice as many.
std::vector<ExactTriangle> sphereTriangles(const glm::dvec3& centre, double radius, int rows) {
  const auto point = [&](int row, int column) {
    const double polar = glm::pi<double>() * row / rows, around = glm::pi<double>() * column / rows;
    return centre + radius * glm::dvec3(std::sin(polar) * std::cos(around), std::cos(polar),
                                        std::sin(polar) * std::sin(around));
  };
  std::vector<ExactTriangle> triangles;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < 2 * rows; ++column) {
      triangles.push_back({point(row, column), point(row + 1, column), point(row + 1, column + 1)});
      triangles.push_back({point(row, column), point(row + 1, column + 1), point(row, column + 1)});
    }
  return triangles;
}

VoxelSet filled(const glm::ivec3& resolution, const std::function<bool(const glm::ivec3&)>& isIn) {
  VoxelSet set(resolution);
  forEachVoxel(resolution, [&](const glm::ivec3& voxel) {
    if (isIn(voxel)) set.insert(voxel);
  });
  return set;
}

VoxelReference touchedBy(const ExactTriangle& triangle, const glm::ivec3& resolution,
                         double tolerance = kContactTolerance) {
  return trueVoxels(std::span(&triangle, 1), resolution, tolerance);
}

bool subset(const VoxelSet& part, const VoxelSet& whole) {
  for (std::size_t i = 0; i < part.words().size(); ++i)
    if ((part.words()[i] & ~whole.words()[i]) != 0) return false;
  return true;
}

}  // namespace

TEST_CASE("a set of voxels keeps what was inserted, and nothing lies outside it") {
  VoxelSet set({5, 7, 3});
  CHECK(set.count() == 0);
  set.insert({4, 6, 2});
  set.insertShared({0, 0, 0});
  set.insertShared({0, 0, 0});
  CHECK(set.count() == 2);
  CHECK((set.contains({4, 6, 2}) && set.contains({0, 0, 0}) && !set.contains({1, 0, 0})));
  CHECK(!set.contains({5, 0, 0}));
  CHECK(!set.contains({-1, 0, 0}));
  CHECK_THROWS_AS(VoxelSet({5000, 1, 1}), Error);
  CHECK_THROWS_AS(VoxelSet({-1, 1, 1}), Error);
}

TEST_CASE("a box between the faces of the voxels touches exactly its shell") {
  // From 2.5 to 12.5 it reaches 11 voxels along each side, and its surface fills all but the inner 9.
  const VoxelReference reference =
      trueVoxels(boxTriangles(glm::dvec3(2.5), glm::dvec3(12.5)), glm::ivec3(16));
  CHECK(reference.certain.count() == cubed(11) - cubed(9));
  CHECK(reference.certain == reference.possible);
}

TEST_CASE("a box on the faces of the voxels touches those on both sides, and a tolerance leaves them open") {
  const std::vector<ExactTriangle> box = boxTriangles(glm::dvec3(3.0), glm::dvec3(9.0));
  // Closed voxels: those from 2 to 9 touch; those strictly within, from 4 to 7, do not.
  const VoxelReference exact = trueVoxels(box, glm::ivec3(16), 0.0);
  CHECK(exact.certain.count() == cubed(8) - cubed(4));
  CHECK(exact.certain == exact.possible);
  const VoxelReference open = trueVoxels(box, glm::ivec3(16));
  CHECK(open.certain.count() == 0);
  CHECK(open.possible == exact.possible);
}

TEST_CASE("a sphere touches the voxels that its radius passes between, and no others") {
  // A voxel meets the sphere when its nearest point is within the radius and its farthest is not. The facets
  // lie inside by at most radius (1 - cos(pi / rows)), times two for the diagonal.
  const glm::dvec3 centre(16.3, 15.8, 16.1);
  constexpr double kRadius = 12.4;
  constexpr int kRows = 160;
  const double sagitta = 2.0 * kRadius * (1.0 - std::cos(glm::pi<double>() / kRows));
  const glm::ivec3 resolution(32);
  const VoxelReference reference = trueVoxels(sphereTriangles(centre, kRadius, kRows), resolution, 0.0);
  std::uint64_t inner = 0, outer = 0, wrong = 0;
  forEachVoxel(resolution, [&](const glm::ivec3& voxel) {
    const glm::dvec3 low = glm::dvec3(voxel) - centre, high = low + 1.0;
    const double nearest = glm::length(glm::max(glm::max(low, -high), 0.0)),
                 farthest = glm::length(glm::max(glm::abs(low), glm::abs(high)));
    const bool must = nearest <= kRadius - sagitta && farthest >= kRadius;
    const bool may = nearest <= kRadius && farthest >= kRadius - sagitta;
    inner += must;
    outer += may;
    wrong += (must && !reference.certain.contains(voxel)) || (!may && reference.certain.contains(voxel));
  });
  CHECK(wrong == 0);
  CHECK(inner <= reference.certain.count());
  CHECK(reference.certain.count() <= outer);
  CHECK(static_cast<double>(outer - inner) < 0.02 * static_cast<double>(outer));
  // The number of voxels that a smooth surface touches tends to area times the mean of |nx|+|ny|+|nz| (its
  // crossings of the voxels' faces), 6 pi r^2 for a sphere; one voxel per crossing.
  CHECK(static_cast<double>(reference.certain.count()) ==
        Approx(6.0 * glm::pi<double>() * kRadius * kRadius).epsilon(0.02));
}

TEST_CASE("random triangles touch every voxel that holds one of their points, and none that is apart") {
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const glm::ivec3 resolution(20);
  for (int run = 0; run < 60; ++run) {
    const double size = run % 3 == 0 ? 0.8 : run % 3 == 1 ? 4.0 : 25.0;
    ExactTriangle triangle;
    const glm::dvec3 at = 20.0 * glm::dvec3(uniform(generator), uniform(generator), uniform(generator));
    for (glm::dvec3& corner : triangle)
      corner = at + size * (glm::dvec3(uniform(generator), uniform(generator), uniform(generator)) - 0.5);
    const VoxelReference reference = touchedBy(triangle, resolution, 0.0);
    // Points of the triangle, none farther from the next than a hundredth of a voxel along each edge.
    const int steps = static_cast<int>(std::ceil(40.0 * size));
    VoxelSet sampled(resolution);
    for (int i = 0; i <= steps; ++i)
      for (int j = 0; i + j <= steps; ++j) {
        const double u = static_cast<double>(i) / steps, v = static_cast<double>(j) / steps;
        const glm::dvec3 point =
            triangle[0] + u * (triangle[1] - triangle[0]) + v * (triangle[2] - triangle[0]);
        const glm::ivec3 voxel(glm::floor(point));
        if (sampled.inside(voxel)) sampled.insert(voxel);
      }
    CHECK(subset(sampled, reference.certain));
    // Voxels that the samples miss are grazed: shrunk by two sample distances, the voxel is not touched any
    // more.
    const VoxelReference deep = touchedBy(triangle, resolution, 0.06);
    CHECK(subset(deep.certain, sampled));
    CHECK(subset(deep.certain, reference.certain));
    CHECK(subset(reference.certain, deep.possible));
  }
}

TEST_CASE("a large triangle is found by dropping whole blocks as by testing every voxel") {
  std::mt19937 generator(9);
  std::uniform_real_distribution<double> uniform(-30.0, 60.0);
  const glm::ivec3 resolution(31, 17, 23);
  for (int run = 0; run < 30; ++run) {
    ExactTriangle triangle;
    for (glm::dvec3& corner : triangle) corner = {uniform(generator), uniform(generator), uniform(generator)};
    const TriangleBoxTest test(triangle);
    const VoxelSet each = filled(resolution, [&](const glm::ivec3& voxel) {
      return test.overlaps(glm::dvec3(voxel) + 0.5, glm::dvec3(0.5));
    });
    CHECK(touchedBy(triangle, resolution, 0.0).certain == each);
  }
}

TEST_CASE("points, lines and needles touch the voxels along them") {
  const glm::ivec3 resolution(32);
  const auto certain = [&](const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, auto... tolerance) {
    return touchedBy({a, b, c}, resolution, tolerance...).certain.count();
  };
  const glm::dvec3 point(3.5), corner(4.0);
  CHECK(certain(point, point, point) == 1);
  CHECK(certain(corner, corner, corner, 0.0) == 8);
  CHECK(certain(corner, corner, corner) == 0);
  CHECK(certain({1.5, 2.5, 2.5}, {9.5, 2.5, 2.5}, {4.5, 2.5, 2.5}) == 9);
  // A slanted line crosses one face after another: one voxel more than it crosses faces.
  const glm::dvec3 from(1.13, 2.29, 3.41), to(29.17, 25.31, 19.47);
  const std::uint64_t faces = (29 - 1) + (25 - 2) + (19 - 3);
  for (const double width : {0.0, 1e-9})
    CHECK(certain(from, to, to + glm::dvec3(width, -width, 0.0), 0.0) == faces + 1);
  // One to a million: as wide as a thirty-thousandth of a voxel, so within the tolerance of the line.
  const VoxelReference thin = touchedBy({from, to, to + glm::dvec3(3.3e-5, -3.3e-5, 0.0)}, resolution);
  CHECK(thin.certain.count() <= faces + 1);
  CHECK(thin.possible.count() >= faces + 1);
  CHECK(subset(touchedBy({from, to, to}, resolution).certain, thin.possible));
}

TEST_CASE("what lies outside the grid or nowhere touches nothing, and what reaches in is cut off") {
  const glm::ivec3 resolution(8);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(),
                   kInfinity = std::numeric_limits<double>::infinity();
  for (const double bad : {kNan, kInfinity, -kInfinity})
    CHECK(
        touchedBy({glm::dvec3(1), glm::dvec3(2, bad, 2), glm::dvec3(3, 1, 1)}, resolution).possible.count() ==
        0);
  const auto levelAt = [&](double z) {
    return touchedBy({glm::dvec3(-1e9, -1e9, z), glm::dvec3(1e9, -1e9, z), glm::dvec3(0, 1e9, z)},
                     resolution);
  };
  CHECK(levelAt(9.0).possible.count() == 0);
  CHECK(levelAt(3.5).certain.count() == 64);
  // Its plane x + y + z = -1.2 passes the grid, though its bounding box does not.
  CHECK(touchedBy({glm::dvec3(-3, 0.9, 0.9), glm::dvec3(0.9, -3, 0.9), glm::dvec3(0.9, 0.9, -3)}, resolution)
            .possible.count() == 0);
}

TEST_CASE("the reference of a scene follows the placement, the motion and the deformation of its objects") {
  SceneBuilder builder;
  builder.box({-1, -1, -1}, {1, 1, 1}, builder.lambert(0.5f), false);
  for (Object& side : builder.scene.objects)
    side.motion = RigidMotion{{0, 1, 0}, 0.0, glm::dvec3(0), {2.0, 0, 0}};
  const GridPlacement grid{{-4.25f, -2.25f, -2.25f}, 0.5f, {20, 9, 9}};
  const auto referenceAt = [&](double time) {
    SceneSnapshot snapshot = snapshotOf(builder.scene, time);
    for (ObjectState& state : snapshot.objects) state.toWorld[3] += glm::vec4(glm::vec3(snapshot.origin), 0);
    return trueVoxels(builder.scene, snapshot, grid).certain;
  };
  // A box of two metres from centre to centre of voxels of half a metre spans five of them.
  const VoxelSet before = referenceAt(0.0), after = referenceAt(1.0);
  CHECK(before.count() == cubed(5) - cubed(3));
  CHECK(after.count() == before.count());
  std::uint64_t moved = 0;
  forEachVoxel(grid.resolution, [&](const glm::ivec3& voxel) {
    moved += before.contains(voxel) && after.contains(voxel + glm::ivec3(4, 0, 0));  // 2 m
  });
  CHECK(moved == before.count());

  SceneSnapshot deformed = snapshotOf(builder.scene, 0.0);
  for (std::size_t i = 0; i < deformed.objects.size(); ++i) {
    const Object& object = builder.scene.objects[i];
    ObjectState& state = deformed.objects[i];
    state.toWorld = glm::mat4(1.0f);
    for (std::uint32_t k = 0; k < object.vertexCount; ++k)
      state.positions.push_back(builder.scene.positions[object.firstVertex + k] * glm::vec3(0.5f, 1, 1));
  }
  CHECK(trueVoxels(builder.scene, deformed, grid).certain.count() == 3 * 5 * 5 - 1 * 3 * 3);
}

TEST_CASE("of a masked surface the holes are empty, the rest is certain and the border between is open") {
  SceneBuilder builder;
  Material material;
  material.maskTexture = 0;
  SurfaceTexture mask;
  mask.width = 64;
  mask.height = 4;
  mask.mask = true;
  mask.values.resize(64 * 4);
  for (std::size_t i = 0; i < mask.values.size(); ++i) mask.values[i] = i % 64 < 32 ? 1.0f : 0.0f;
  builder.scene.textures.push_back(mask);
  // One square of 16 voxels; the mask repeats along neither side.
  builder.quad({0, 0, 0.5f}, {16, 0, 0}, {0, 16, 0}, builder.material(material));
  for (std::size_t i = 0; i < builder.scene.positions.size(); ++i)
    builder.scene.texcoords[i] = glm::vec2(builder.scene.positions[i]) / 16.0f;
  SceneSnapshot snapshot = snapshotOf(builder.scene, 0.0);
  snapshot.objects[0].toWorld = glm::mat4(1.0f);
  const VoxelReference reference = trueVoxels(builder.scene, snapshot, {{0, 0, 0}, 1.0f, {16, 16, 1}});
  // Four texels to a voxel. Half of the width is solid: voxels 0 to 7. The mask repeats, so the solid texel
  // at 0 is next to the hole's end at 16, where filtering reaches half a texel from both sides.
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 8; ++x) CHECK(reference.certain.contains({x, y, 0}));
    for (int x = 9; x < 15; ++x) CHECK(!reference.possible.contains({x, y, 0}));
    for (const int x : {8, 15}) CHECK(reference.possible.contains({x, y, 0}));
  }
}

TEST_CASE("precision and recall count certain voxels, and undecided ones for neither") {
  const glm::ivec3 resolution(10, 1, 1);  // no voxel has all its neighbours within
  const auto upTo = [&](int low, int high) {
    return filled(resolution, [&](const glm::ivec3& voxel) { return voxel.x >= low && voxel.x < high; });
  };
  const VoxelReference reference{upTo(2, 6), upTo(1, 7)}, nothing{upTo(0, 0), upTo(0, 0)};
  const VoxelError error = compareVoxels(upTo(4, 9), reference);
  CHECK((error.truePositive == 2 && error.falsePositive == 2 && error.falseNegative == 2));
  CHECK((error.precision() == 0.5 && error.recall() == 0.5));
  for (const VoxelError& right : {compareVoxels(upTo(1, 7), reference), compareVoxels(upTo(2, 6), reference),
                                  compareVoxels(upTo(0, 0), nothing)})
    CHECK((right.precision() == 1.0 && right.recall() == 1.0));
  CHECK(compareVoxels(upTo(0, 0), reference).recall() == 0.0);
  CHECK_THROWS_AS(compareVoxels(VoxelSet({1, 1, 1}), reference), Error);
}

TEST_CASE("a wall between two layers of voxels may lie in either, but not in none") {
  const glm::ivec3 resolution(8, 8, 9);
  const VoxelReference reference =
      trueVoxels(parallelogram({1.5, 1.5, 4.0}, {5, 0, 0}, {0, 5, 0}), resolution);
  CHECK(reference.certain.count() == 0);
  CHECK(reference.possible.count() == 2 * 6 * 6);
  const auto layer = [&](int z) {
    return filled(resolution, [&](const glm::ivec3& v) {
      return v.z == z && v.x >= 1 && v.x <= 6 && v.y >= 1 && v.y <= 6;
    });
  };
  for (const int z : {3, 4}) {
    const VoxelError error = compareVoxels(layer(z), reference);
    CHECK((error.recall() == 1.0 && error.precision() == 1.0));
  }
  CHECK(compareVoxels(VoxelSet(resolution), reference).recall() == 0.0);
  CHECK(compareVoxels(VoxelSet(resolution), reference).falseNegative == 2 * 6 * 6);
}

TEST_CASE("a missing voxel of a wall is a hole for as many rays as pass through it from face to face") {
  constexpr int kSide = 24;
  const glm::ivec3 resolution(kSide, kSide, 9);
  const VoxelSet wall = filled(resolution, [](const glm::ivec3& voxel) { return voxel.z == 4; });
  const glm::ivec3 missing(11, 13, 4);
  const VoxelSet torn =
      filled(resolution, [&](const glm::ivec3& voxel) { return voxel.z == 4 && voxel != missing; });
  const VoxelReference reference{wall, wall};
  constexpr int kRays = 1 << 21;
  const RayHoles whole = rayHoles(wall, reference, kRays), holes = rayHoles(torn, reference, kRays);
  CHECK((whole.axisHoles == 0 && whole.obliqueHoles == 0));
  // Along z there is one ray a voxel; along x and y one a row, and each of those meets occupied voxels.
  CHECK(holes.axisCrossings == kSide * kSide + 2 * kSide);
  CHECK(holes.axisHoles == 1);
  // Of all lines that meet a convex body, its surface says how many (Cauchy): pi times the surface, 2 n^2 + 4
  // n. Those that go through both faces of the missing voxel are 2 pi F, F the form factor of two opposite
  // unit squares one unit apart, 0.199825. Others meet a neighbour, which is occupied.
  constexpr double kFormFactor = 0.199825;
  const double expected = kFormFactor / (kSide * kSide + 2.0 * kSide);
  INFO(holes.obliqueHoles << " of " << holes.obliqueCrossings);
  CHECK(holes.obliqueShare() == Approx(expected).epsilon(0.1));
  CHECK(holes.axisShare() == 1.0 / (kSide * kSide + 2 * kSide));
}

TEST_CASE("what lies within a voxel and a half of the surface along the ray stops it, and nothing farther") {
  const glm::ivec3 resolution(4, 4, 12);
  constexpr int kAllColumns = 4 * 12;
  const VoxelSet wall = filled(resolution, [](const glm::ivec3& voxel) { return voxel.z == 6; });
  for (int z = 0; z < resolution.z; ++z) {
    const VoxelSet shifted = filled(resolution, [&](const glm::ivec3& voxel) { return voxel.z == z; });
    const RayHoles holes = rayHoles(shifted, {wall, wall}, kAllColumns);
    // Rays along z see it up to two voxels away (one voxel between them); those within the wall never do.
    const std::uint64_t within = z == 6 ? 0 : 4 + 4;
    CHECK(holes.axisHoles == within + (std::abs(z - 6) <= 2 ? 0 : 16));
  }
  // A surface behind another one is a surface of its own.
  const VoxelSet two = filled(resolution, [](const glm::ivec3&v) { return v.z == 2 || v.z == 9; }),
                 one = filled(resolution, [](const glm::ivec3&v) { return v.z == 2; });
  CHECK(rayHoles(one, {two, two}, kAllColumns).axisHoles == 16 + 4 + 4);
  CHECK_THROWS_AS(rayHoles(VoxelSet({1, 1, 1}), {wall, wall}), Error);
  CHECK(rayHoles(VoxelSet(resolution), {VoxelSet(resolution), VoxelSet(resolution)}).axisShare() == 0.0);
}

TEST_CASE("voxels that are undecided make no crossing of their own, and lengthen those of others") {
  const glm::ivec3 resolution(4, 4, 12);
  constexpr int kAllColumns = 4 * 12;
  const auto layers = [&](int low, int high) {
    return filled(resolution, [&](const glm::ivec3& v) { return v.z >= low && v.z <= high; });
  };
  const VoxelSet none(resolution);
  CHECK(rayHoles(none, {none, layers(5, 6)}, kAllColumns).axisCrossings == 0);
  // Rays along x and y meet the certain layer alone; those along z meet both as one surface.
  const RayHoles both = rayHoles(layers(5, 5), {layers(6, 6), layers(5, 6)}, kAllColumns);
  CHECK(both.axisCrossings == 16 + 4 + 4);
  CHECK(both.axisHoles == 4 + 4);
}

TEST_CASE("voxels and holes have the same bits on any number of threads") {
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> uniform(0.0, 64.0);
  std::vector<ExactTriangle> triangles(2000);
  for (ExactTriangle& triangle : triangles)
    for (glm::dvec3& corner : triangle) corner = {uniform(generator), uniform(generator), uniform(generator)};
  const glm::ivec3 resolution(64);
  const auto all = [&] { return trueVoxels(std::span(triangles).first(200), resolution); };
  const VoxelReference many = all();
  VoxelReference one;
  RayHoles oneHoles;
  {
    const tbb::global_control single(tbb::global_control::max_allowed_parallelism, 1);
    one = all();
    oneHoles = rayHoles(VoxelSet(resolution), one, 1000);
  }
  CHECK(one.certain == many.certain);
  CHECK(one.possible == many.possible);
  const RayHoles holes = rayHoles(VoxelSet(resolution), many, 1000);
  CHECK(holes.obliqueCrossings == oneHoles.obliqueCrossings);
  CHECK(holes.obliqueHoles == oneHoles.obliqueHoles);
  CHECK(holes.obliqueHoles == holes.obliqueCrossings);
}
