// Rays that end at the surface within a voxel: against the triangles that the voxels were made from.
#include <cmath>
#include <limits>
#include <random>

#include "lumivox/base/error.h"
#include "support/facts.h"
#include "support/form_factors.h"
#include "support/near_field.h"
#include "support/voxel_fragments.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::near_field;

namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

struct Ray {
  glm::dvec3 origin, direction;  ///< in metres of the scene; of unit length
};

/// A scene in voxels, and rays through them.
class Voxelized {
 public:
  Voxelized(const SceneBuilder& builder, int resolution)
      : scene(builder.scene), snapshot(snapshotOf(scene, 0.0)) {
    fragments = fragmentsIn(scene, {{"resolution", resolution}});
    bits = LonePass("voxelization.average", scene).in("fragments", fragments).out<BinaryGrid>("bits");
  }
  double voxel() const { return bits.grid.voxelSize; }

  /// The way to the first triangle.
  double exact(const Ray& ray) const {
    double nearest = kNever;
    for (std::size_t i = 0; i < scene.indices.size(); i += 3) {
      const auto at = [&](std::size_t k) { return glm::dvec3(scene.positions[scene.indices[i + k]]); };
      const glm::dvec3 a = at(0), e1 = at(1) - a, e2 = at(2) - a, p = glm::cross(ray.direction, e2);
      const double determinant = glm::dot(e1, p);
      if (determinant == 0.0) continue;
      const glm::dvec3 from = ray.origin - a, q = glm::cross(from, e1);
      const double u = glm::dot(from, p) / determinant, v = glm::dot(ray.direction, q) / determinant,
                   t = glm::dot(e2, q) / determinant;
      if (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0) nearest = std::min(nearest, t);
    }
    return nearest;
  }

  /// The way to where each ray ends; infinite: nowhere.
  std::vector<double> ends(const std::vector<Ray>& rays, const Settings& settings) const {
    constexpr int kWidth = 256;
    const int height = (static_cast<int>(rays.size()) + kWidth - 1) / kWidth;
    std::vector<float> origins(static_cast<std::size_t>(4 * kWidth * height), -1.0f), directions(origins);
    for (std::size_t i = 0; i < rays.size(); ++i)
      for (int c = 0; c < 4; ++c) {
        const auto at = 4 * i + static_cast<std::size_t>(c);
        origins[at] = c < 3 ? static_cast<float>(rays[i].origin[c] - snapshot.origin[c]) : 1e6f;
        directions[at] = c < 3 ? static_cast<float>(rays[i].direction[c]) : 0.0f;
      }
    LonePass probe("near_field_voxels.probe", scene, settings);
    probe.in("bits", bits)
        .in("fragments", fragments)
        .in("origins", Image{textureOf(pixels(kWidth, height), origins)})
        .in("directions", Image{textureOf(pixels(kWidth, height), directions)});
    const std::vector<float> hits = probe.floats("hits");
    std::vector<double> result;
    for (std::size_t i = 0; i < rays.size(); ++i)
      result.push_back(hits[4 * i] < 0.0f ? kNever : hits[4 * i + 3]);
    return result;
  }

  Scene scene;
  SceneSnapshot snapshot;
  VoxelFragments fragments;
  BinaryGrid bits;
};

const Settings kAtPlanes{{"stop", "plane"}};

/// From places around one, towards places within another box.
std::vector<Ray> raysBetween(const glm::dvec3& from, double fromSide, const glm::dvec3& to, double toSide,
                             int count) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-0.5, 0.5);
  const auto place = [&] { return glm::dvec3(unit(random), unit(random), unit(random)); };
  std::vector<Ray> rays;
  for (int i = 0; i < count; ++i) {
    const glm::dvec3 origin = from + fromSide * place();
    rays.push_back({origin, glm::normalize(to + toSide * place() - origin)});
  }
  return rays;
}

/// How rays end beside where they would in the triangles.
struct Compared {
  double near = 0.0;    ///< share of the rays that hit a triangle and end within a tenth of a voxel of it
  double before = 0.0;  ///< mean way by which they end before it, voxels
  double free = 0.0;    ///< share of the rays that hit no triangle and end nowhere
};

Compared compared(const Voxelized& voxels, const std::vector<Ray>& rays, const Settings& settings) {
  const std::vector<double> ends = voxels.ends(rays, settings);
  int hits = 0, misses = 0, met = 0;
  Compared result;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const double exact = voxels.exact(rays[i]);
    if (std::isinf(exact)) {
      ++misses;
      result.free += std::isinf(ends[i]);
      continue;
    }
    ++hits;
    const double before = (exact - ends[i]) / voxels.voxel();
    result.near += std::abs(before) < 0.1;
    if (std::isinf(ends[i])) continue;
    ++met;
    result.before += before;
  }
  result.near /= std::max(hits, 1);
  result.before /= std::max(met, 1);
  result.free = misses > 0 ? result.free / misses : 1.0;
  return result;
}

/// A solid box beside the voxels' faces, in a room that is far larger, 32 voxels of a metre.
SceneBuilder solidBox() {
  SceneBuilder builder;
  const int white = builder.lambert(0.5f);
  builder.box(glm::vec3(-16.0f), glm::vec3(16.0f), white, true);
  builder.box({-4.3f, -3.6f, -5.2f}, {4.4f, 3.3f, 5.7f}, white, false);
  return builder;
}

/// A room of 16 m around the origin, whose voxels are about a metre wide in a grid of 16.
SceneBuilder room16() {
  SceneBuilder builder;
  builder.box(glm::vec3(-8.0f), glm::vec3(8.0f), builder.lambert(0.5f), true);
  return builder;
}

SceneBuilder slantedSheet() {
  SceneBuilder builder;
  builder.quad({-8, -3, -8}, {1, 2, 16}, {16, 4, -1}, builder.lambert(0.5f));
  return builder;
}

}  // namespace

TEST_CASE("a ray ends where it meets a slanted surface, from either side, and at boxes half a voxel before") {
  const Voxelized voxels(slantedSheet(), 32);
  for (const double side : {1.0, -1.0}) {
    const std::vector<Ray> rays = raysBetween({1, side * 9, 0}, 5.0, {0, 0, 0}, 5.0, 2000);
    const std::vector<double> ends = voxels.ends(rays, kAtPlanes);
    double furthest = 0.0;
    for (std::size_t i = 0; i < rays.size(); ++i)
      furthest = std::max(furthest, std::abs(ends[i] - voxels.exact(rays[i])) / voxels.voxel());
    CAPTURE(side, furthest);
    CHECK(furthest < 0.02);
    CHECK(compared(voxels, rays, {}).before > 0.4);
  }
}

TEST_CASE("rays find the same ends by the hierarchy, the stacks and one voxel after another") {
  const Voxelized voxels(solidBox(), 32);
  const std::vector<Ray> rays = raysBetween({1, 2, 3}, 28.0, {0, 0, 0}, 14.0, 20000);
  const std::vector<double> ends = voxels.ends(rays, kAtPlanes);
  for (const char* method : {"stacks", "plain"})
    CHECK(voxels.ends(rays, {{"stop", "plane"}, {"method", method}}) == ends);
}

TEST_CASE("a ray passes beside a convex edge, where no plane stands out beyond the other") {
  const Voxelized voxels(solidBox(), 32);
  // Along the edge at (4.4, 3.3), and past it by up to a voxel.
  std::vector<Ray> rays;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int i = 0; i < 2000; ++i) {
    const double z = -4.0 + 8.0 * unit(random), beyond = 0.1 + 0.6 * unit(random),
                 slope = 2.0 * unit(random) - 1.0;
    // Across the edge, at `beyond` of it along the diagonal.
    const glm::dvec3 through(4.4 + beyond / std::sqrt(2.0), 3.3 + beyond / std::sqrt(2.0), z),
        direction = glm::normalize(glm::dvec3(1, -1, slope));
    rays.push_back({through - 6.0 * direction, direction});
  }
  int stopped = 0, atBoxes = 0;
  const std::vector<double> ends = voxels.ends(rays, kAtPlanes), boxes = voxels.ends(rays, {});
  for (std::size_t i = 0; i < rays.size(); ++i) {
    REQUIRE(voxels.exact(rays[i]) > 7.0);
    stopped += ends[i] < 7.0;
    atBoxes += boxes[i] < 7.0;
  }
  CAPTURE(stopped, atBoxes);
  CHECK(stopped < 20);
  CHECK(atBoxes > 1000);
}

TEST_CASE("rays end at the faces of a solid box, its edges and corners included") {
  const Voxelized voxels(solidBox(), 32);
  const Compared planes = compared(voxels, raysBetween({13, 12, 11}, 4.0, {0, 0, 0}, 12.0, 10000), kAtPlanes);
  CAPTURE(planes.near, planes.before);
  CHECK(planes.near > 0.975);
}

TEST_CASE("rays end at the walls of a room, in its concave corners too") {
  SceneBuilder builder;
  builder.box({-7.7f, -6.4f, -7.1f}, {7.4f, 7.8f, 6.6f}, builder.lambert(0.5f), true);
  const Voxelized voxels(builder, 16);
  const std::vector<Ray> rays = raysBetween({0, 0, 0}, 4.0, {0, 0, 0}, 24.0, 10000);
  const Compared planes = compared(voxels, rays, kAtPlanes);
  CAPTURE(planes.near, planes.before);
  CHECK(planes.near > 0.97);
  int leave = 0;
  for (const double end : voxels.ends(rays, kAtPlanes)) leave += std::isinf(end);
  CAPTURE(leave);
  CHECK(leave <= 10);  // where three walls meet in one voxel, which has two planes
}

TEST_CASE("the two sides of a wall within a voxel end rays apart") {
  SceneBuilder builder;
  const int white = builder.lambert(0.5f);
  builder.box(glm::vec3(-8.0f), glm::vec3(8.0f), white, true);
  builder.quad({-8, 0.3f, -8}, {16, 0, 0}, {0, 0, 16}, white);  // faces down
  builder.quad({-8, 0.7f, -8}, {0, 0, 16}, {16, 0, 0}, white);  // faces up
  const Voxelized voxels(builder, 16);
  for (const double side : {1.0, -1.0}) {
    const Compared planes =
        compared(voxels, raysBetween({0, side * 5, 0}, 3.0, {0, 0, 0}, 3.0, 2000), kAtPlanes);
    CAPTURE(side, planes.near, planes.before);
    CHECK(planes.near > 0.999);
    CHECK(std::abs(planes.before) < 0.02);
  }
}

TEST_CASE("a ray along a sheet passes all voxels of it, and ends at the wall behind them") {
  SceneBuilder builder;
  const int white = builder.lambert(0.5f);
  builder.quad({-8, -1, -8}, {0, 0, 16}, {16, 2, 0}, white);
  builder.quad({8, -8, -8}, {0, 16, 0}, {0, 0, 16}, white);
  const Voxelized voxels(builder, 256);
  std::vector<Ray> rays;
  for (int i = 0; i < 256; ++i) {
    const double z = -7.0 + i / 20.0;
    // Nearly parallel to the sheet, a third of a voxel above it.
    rays.push_back({{-7.5, -7.5 / 8.0 + 0.4 * voxels.voxel(), z}, glm::normalize(glm::dvec3(8, 1, 0.3))});
  }
  for (const char* method : {"hierarchy", "stacks", "plain"}) {
    const std::vector<double> ends = voxels.ends(rays, {{"stop", "plane"}, {"method", method}});
    for (std::size_t i = 0; i < rays.size(); ++i) {
      CAPTURE(method, i);
      CHECK(std::abs(ends[i] - voxels.exact(rays[i])) < 0.05 * voxels.voxel());
    }
  }
}

TEST_CASE("rays end at the same places in any order of the fragments") {
  Voxelized voxels(solidBox(), 32);
  const std::vector<Ray> rays = raysBetween({1, 2, 3}, 28.0, {0, 0, 0}, 14.0, 5000);
  const std::vector<double> ends = voxels.ends(rays, kAtPlanes);
  std::vector<FragmentData> all = voxels.fragments.fragments->downloadValues<FragmentData>();
  const std::uint32_t count = voxels.fragments.count->downloadValues<std::uint32_t>()[0];
  std::reverse(all.begin(), all.begin() + count);
  voxels.fragments.fragments = bufferOf(all);
  CHECK(voxels.ends(rays, kAtPlanes) == ends);
}

TEST_CASE("in a voxel without fragments a ray ends at the box, with planes too") {
  Voxelized voxels(slantedSheet(), 32);
  VoxelSet one(voxels.bits.grid.resolution);
  const glm::ivec3 corner(0, voxels.bits.grid.resolution.y - 1, 0);  // the sheet lies deeper there
  one.insert(corner);
  const GridPlacement grid = voxels.bits.grid;
  voxels.bits = gridOf(one);
  voxels.bits.grid = grid;
  const glm::dvec3 middle =
      glm::dvec3(grid.low) + voxels.voxel() * (glm::dvec3(corner) + 0.5) + voxels.snapshot.origin;
  const Ray ray{middle + glm::dvec3(0, 0, -3), {0, 0, 1}};
  CHECK(voxels.ends({ray}, kAtPlanes)[0] == Approx(3.0 - 0.5 * voxels.voxel()).epsilon(1e-5));
}

TEST_CASE("a point beside a wall is occluded by the wall, where boxes take all of the hemisphere") {
  SceneBuilder builder;
  const int white = builder.lambert(0.5f);
  builder.quad({-8, -0.6f, -8}, {0, 0, 16}, {16, 0, 0}, white);      // floor
  builder.quad({2.8f, -0.6f, -8}, {0, 0, 16}, {0, 6.0f, 0}, white);  // wall
  const Voxelized voxels(builder, 16);
  const glm::dvec3 point(2.8 - 0.3, -0.6, 0.1);
  const double expected = polygonFormFactor(point, glm::dvec3(0, 1, 0),
                                            {{2.8, -0.6, -8}, {2.8, -0.6, 8}, {2.8, 5.4, 8}, {2.8, 5.4, -8}});
  const auto occluded = [&](const Settings& settings) {
    Gatherer gatherer(voxels.bits, voxels.scene);
    gatherer.in("fragments", voxels.fragments);
    gatherer.at(point - voxels.snapshot.origin, kUp)
        .with({{"rays", 4096}, {"occlusion_distance", 1000}})
        .with(settings);
    return 1.0 - gatherer.mean("occlusion");
  };
  const double planes = occluded({{"stop", "plane"}, {"offset", 0.1}}), boxes = occluded({{"offset", 1.0}});
  CAPTURE(expected, planes, boxes);
  CHECK(planes == Approx(expected).epsilon(0.05));
  CHECK(std::abs(boxes - expected) > 3.0 * std::abs(planes - expected));
}

TEST_CASE("a ray from the lower of two steps within a voxel passes the plane between them") {
  SceneBuilder builder = room16();
  const int white = builder.lambert(0.5f);
  builder.quad({-7, 0.3f, -7}, {0, 0, 14}, {7.5f, 0, 0}, white);
  builder.quad({0.5f, 0.7f, -7}, {0, 0, 14}, {6.5f, 0, 0}, white);
  const Voxelized voxels(builder, 16);
  const glm::dvec3 point(0.3, 0.3, 0.1);
  Gatherer gatherer(voxels.bits, voxels.scene);
  gatherer.in("fragments", voxels.fragments);
  gatherer.at(point - voxels.snapshot.origin, kUp)
      .with({{"rays", 4096}, {"occlusion_distance", 4}, {"stop", "plane"}, {"offset", 0.1}});
  // The upper step is seen from its edge, and takes nothing of the sky.
  const double occluded = 1.0 - gatherer.mean("occlusion");
  CAPTURE(occluded);
  CHECK(occluded < 0.2);
}

TEST_CASE("rays end at the last voxel of a thin wall too, where both sides make one plane") {
  SceneBuilder builder = room16();
  const int white = builder.lambert(0.5f);
  builder.quad({-7, 0.3f, -7}, {7.5f, 0, 0}, {0, 0, 14}, white);    // faces down
  builder.quad({-7, 0.7f, -7}, {0, 0, 14}, {7.5f, 0, 0}, white);    // faces up
  builder.quad({0.5f, 0.3f, -7}, {0, 0.4f, 0}, {0, 0, 14}, white);  // the end
  const Voxelized voxels(builder, 16);
  std::vector<Ray> rays;
  for (int i = 0; i < 100; ++i)
    for (const double side : {1.0, -1.0})
      rays.push_back({{0.2 + 0.002 * i, 0.5 + side * 4.0, -5.0 + 0.1 * i}, {0, -side, 0}});
  for (const double end : voxels.ends(rays, kAtPlanes)) CHECK(end == Approx(4.0).margin(0.3));
}

TEST_CASE("behind voxels that a ray passes it ends at the box of one without planes") {
  SceneBuilder builder = room16();
  builder.quad({-7, 0.3f, -7}, {0, 0, 9}, {14, 0, 0}, builder.lambert(0.5f));
  Voxelized voxels(builder, 16);
  const GridPlacement grid = voxels.bits.grid;
  VoxelSet set(grid.resolution);
  for (const Cell& cell : cellsOf(voxels.bits)) set.insert({cell[0], cell[1], cell[2]});
  // Above the sheet, in its voxels, and along z.
  const Ray ray{{0.4, 0.8, -6}, {0, 0, 1}};
  const glm::dvec3 low = glm::dvec3(grid.low) + voxels.snapshot.origin;
  // Just behind the last voxel of the sheet.
  const glm::ivec3 further =
      glm::ivec3(glm::floor((glm::dvec3(0.4, 0.8, 2.0) - low) / voxels.voxel())) + glm::ivec3(0, 0, 1);
  const double box = low.z + voxels.voxel() * further.z + 6.0;
  for (const char* method : {"hierarchy", "stacks", "plain"}) {
    const Settings settings{{"stop", "plane"}, {"method", method}};
    CHECK(voxels.ends({ray}, settings)[0] > box + 1.0);  // the wall of the room
    Voxelized more = voxels;
    VoxelSet with = set;
    with.insert(further);
    more.bits = gridOf(with);
    more.bits.grid = grid;
    CHECK(more.ends({ray}, settings)[0] == Approx(box).epsilon(1e-5));
  }
}

TEST_CASE("rays that end at boxes ignore the fragments, to the bit") {
  const Voxelized voxels(solidBox(), 32);
  const auto open = [&](bool connected) {
    Gatherer gatherer(voxels.bits, voxels.scene);
    if (connected) gatherer.in("fragments", voxels.fragments);
    gatherer.at({0, 9, 0}, kUp).with({{"rays", 64}, {"occlusion_distance", 1000}});
    return gatherer.floats("occlusion");
  };
  CHECK(open(true) == open(false));
}

TEST_CASE("planes are kept while the camera alone moves, and follow what turns") {
  const Scene scene = committed("spinning_box");
  const Pipeline text = pipeline("near_field_voxels");
  RenderOptions options = sized(24, 24);
  options.interactive = true;
  options.parameters = text.settings({"resolution=32", "rays=4", "stop=plane"});
  PipelineExecutor executor(device(), techniques(), scene, text, options);
  const auto sameAsAlone = [&](const SceneSnapshot& snapshot) {
    PipelineExecutor alone(device(), techniques(), scene, text, options);
    return executor.render(snapshot).outputs.at("indirect_diffuse").values() ==
           alone.render(snapshot).outputs.at("indirect_diffuse").values();
  };
  const auto reused = [&] {
    const auto& leftOut = executor.explain().leftOut;
    return std::any_of(leftOut.begin(), leftOut.end(), [](const LeftOut& one) {
      return one.what == "gather: planes within voxels in later frames";
    });
  };
  SceneSnapshot snapshot = snapshotOf(scene, 0.0, {}, 24, 24);
  CHECK(sameAsAlone(snapshot));
  CHECK(sameAsAlone(snapshotOf(scene, 0.5, {}, 24, 24)));
  CHECK_FALSE(reused());
  snapshot = snapshotOf(scene, 0.5, {}, 24, 24);
  snapshot.camera.eye.x += 0.1f;
  CHECK(sameAsAlone(snapshot));
  CHECK(reused());
}

TEST_CASE("planes without fragments, of another grid or with the printed walk are refused") {
  const Voxelized voxels(solidBox(), 32), other(solidBox(), 16);
  const auto gather = [&](const Settings& settings) {
    Gatherer gatherer(voxels.bits, voxels.scene);
    gatherer.at({0, 9, 0}, kUp).with({{"rays", 4}, {"occlusion_distance", 1000}}).with(settings);
    return gatherer;
  };
  CHECK_THROWS_MATCHES(gather(kAtPlanes).run(), Error, Tells("stop plane", "fragments", "connected"));
  CHECK_THROWS_MATCHES(gather(kAtPlanes).in("fragments", other.fragments).run(), Error,
                       Tells("bits", 32, "fragments", 16, "one grid"));
  CHECK_THROWS_MATCHES(
      gather({{"stop", "plane"}, {"method", "printed"}}).in("fragments", voxels.fragments).run(), Error,
      Tells("stop plane", "method printed", "stop box"));
}
