// Every piece of a scene's surface has texels of its own, close enough to each other.
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <set>

#include "lumivox/base/error.h"
#include "lumivox/scene/atlas.h"
#include "lumivox/scene/topology.h"
#include "support/facts.h"
#include "support/scene_builder.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

glm::dvec3 corner(const Scene& scene, std::uint32_t triangle, std::uint32_t k) {
  return scene.positions[scene.indices[3 * triangle + k]];
}

glm::dvec3 place(const Scene& scene, const AtlasTexel& texel) {
  const double b = texel.second, c = texel.third;
  return (1.0 - b - c) * corner(scene, texel.triangle, 0) + b * corner(scene, texel.triangle, 1) +
         c * corner(scene, texel.triangle, 2);
}

/// Adds triangles of shared vertices as one object.
void addTriangles(Scene& scene, const std::vector<glm::vec3>& places,
                  const std::vector<std::uint32_t>& corners) {
  if (scene.materials.empty()) scene.materials.emplace_back();
  Object object;
  object.firstVertex = static_cast<std::uint32_t>(scene.positions.size());
  object.vertexCount = static_cast<std::uint32_t>(places.size());
  object.parts.push_back(
      {0, static_cast<std::uint32_t>(scene.indices.size()), static_cast<std::uint32_t>(corners.size())});
  scene.positions.insert(scene.positions.end(), places.begin(), places.end());
  scene.normals.resize(scene.positions.size(), glm::vec3(0, 1, 0));
  scene.texcoords.resize(scene.positions.size());
  for (const std::uint32_t c : corners) scene.indices.push_back(object.firstVertex + c);
  scene.objects.push_back(object);
}

/// A height field or any other map of the unit square, cut into 2 n^2 triangles.
template <class Map>
Scene gridOf(int n, Map&& map) {
  Scene scene = SceneBuilder().scene;
  std::vector<glm::vec3> places;
  std::vector<std::uint32_t> corners;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i)
      places.push_back(map(static_cast<double>(i) / n, static_cast<double>(j) / n));
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(j * (n + 1) + i); };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)
      for (const std::uint32_t c :
           {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1), at(i, j + 1)})
        corners.push_back(c);
  addTriangles(scene, places, corners);
  return scene;
}

/// A ramp of three turns around an axis, wide and low: seen along the axis it covers itself twice.
Scene spiralRamp() {
  return gridOf(60, [](double u, double v) {
    const double angle = 6.0 * kPi * u, radius = 0.5 + 0.5 * v;
    return glm::vec3(radius * std::cos(angle), 0.6 * u, radius * std::sin(angle));
  });
}

Scene roundSphere() {
  return gridOf(48, [](double u, double v) {
    return glm::vec3(std::sin(kPi * v) * std::cos(2 * kPi * u), std::cos(kPi * v),
                     std::sin(kPi * v) * std::sin(2 * kPi * u));
  });
}

Scene looseTriangles() {
  SceneBuilder builder;
  const int grey = builder.lambert(0.5f);
  std::mt19937 generator(3);
  std::uniform_real_distribution<float> uniform(-1.0f, 1.0f);
  const auto vector = [&] { return glm::vec3(uniform(generator), uniform(generator), uniform(generator)); };
  for (int i = 0; i < 60; ++i) builder.quad(vector(), 0.4f * vector(), 0.4f * vector(), grey);
  // A point, a line and a needle are surfaces too.
  addTriangles(builder.scene, {{0, 2, 0}, {1, 2, 0}, {0.5f, 2, 0}, {0.5f, 2.2f, 1e-6f}, {0.6f, 2.8f, 0}},
               {0, 0, 0, 0, 1, 2, 2, 3, 4});
  return builder.scene;
}

/// The farthest that a point of the surface lies from the nearest texel's place, in texels, among `samples`
/// random points.
double farthestGap(const Scene& scene, const SurfaceAtlas& atlas, double texelSize, int samples) {
  std::vector<glm::dvec3> places;
  for (const AtlasTexel& texel : atlas.texels) places.push_back(place(scene, texel));
  std::sort(places.begin(), places.end(), [](const auto& a, const auto& b) { return a.x < b.x; });
  std::mt19937 generator(17);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  double farthest = 0.0;
  for (int i = 0; i < samples; ++i) {
    const auto t =
        static_cast<std::uint32_t>(uniform(generator) * static_cast<double>(scene.triangleCount()));
    const double root = std::sqrt(uniform(generator)), across = uniform(generator);
    const glm::dvec3 point = (1.0 - root) * corner(scene, t, 0) +
                             root * (1.0 - across) * corner(scene, t, 1) +
                             root * across * corner(scene, t, 2);
    const double reach = 5.0 * texelSize;
    double nearest = reach;
    for (auto at = std::lower_bound(places.begin(), places.end(), point.x - reach,
                                    [](const glm::dvec3&p, double x) { return p.x < x; });
         at != places.end() && at->x <= point.x + reach; ++at)
      nearest = std::min(nearest, glm::length(*at - point));
    farthest = std::max(farthest, nearest / texelSize);
  }
  return farthest;
}

/// Of the unit square, mapped to a plane: how many outlines hold a random point, over points and outlines.
struct Tiling {
  int holes = 0, overlaps = 0;
  double area = 0.0;  ///< of all outlines, m^2
};
Tiling tilingOf(const Scene& scene, double texelSize) {
  const SurfaceAtlas atlas =
      makeSurfaceAtlas(scene, std::vector<double>(scene.objects.size(), texelSize), AtlasPlaces::middles);
  REQUIRE(atlas.outlines.size() == atlas.texels.size());
  std::vector<std::vector<glm::dvec2>> polygons;  // x and z
  Tiling tiling;
  for (std::size_t i = 0; i < atlas.texels.size(); ++i) {
    const AtlasTexel& texel = atlas.texels[i];
    const glm::dvec3 e1 = corner(scene, texel.triangle, 1) - corner(scene, texel.triangle, 0),
                     e2 = corner(scene, texel.triangle, 2) - corner(scene, texel.triangle, 0);
    std::vector<glm::dvec2>& polygon = polygons.emplace_back();
    REQUIRE(atlas.outlines[i].count >= 3);
    for (std::uint32_t k = 0; k < atlas.outlines[i].count; ++k) {
      const glm::dvec2 step(atlas.outlines[i].corners[k]);
      const glm::dvec3 at = place(scene, texel) + step.x * e1 + step.y * e2;
      polygon.emplace_back(at.x, at.z);
    }
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      const glm::dvec2 &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
      tiling.area += 0.5 * (a.y * b.x - a.x * b.y);  // counter-clockwise as seen from above
    }
  }
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (int i = 0; i < 4000; ++i) {
    const auto t =
        static_cast<std::uint32_t>(uniform(generator) * static_cast<double>(scene.triangleCount()));
    const double root = std::sqrt(uniform(generator)), across = uniform(generator);
    const glm::dvec3 point = (1.0 - root) * corner(scene, t, 0) +
                             root * (1.0 - across) * corner(scene, t, 1) +
                             root * across * corner(scene, t, 2);
    int inside = 0, near = 0;
    for (const std::vector<glm::dvec2>& polygon : polygons) {
      double least = 1e9;
      for (std::size_t k = 0; k < polygon.size(); ++k) {
        const glm::dvec2 &a = polygon[k], &b = polygon[(k + 1) % polygon.size()], side = b - a;
        least = std::min(least, (side.y * (point.x - a.x) - side.x * (point.z - a.y)) / glm::length(side));
      }
      inside += least >= 0.0;
      near += std::abs(least) < 1e-6;
    }
    tiling.holes += inside == 0 && near == 0;
    tiling.overlaps += inside > 1 && near == 0;
  }
  return tiling;
}

}  // namespace

TEST_CASE("no two pieces of surface share a texel, and every texel lies in the square and on its triangle") {
  for (const Scene& scene : {litRoom(8, 8), roundSphere(), spiralRamp(), looseTriangles()}) {
    const SurfaceAtlas atlas = makeSurfaceAtlas(scene, 0.03);
    std::set<std::pair<int, int>> taken;
    for (const AtlasTexel& texel : atlas.texels) {
      CHECK(taken.insert({texel.x, texel.y}).second);
      CHECK(texel.x < atlas.side);
      CHECK(texel.y < atlas.side);
      CHECK(texel.triangle < scene.triangleCount());
      CHECK((texel.second >= 0.0f && texel.third >= 0.0f && texel.second + texel.third <= 1.0f + 1e-6f));
    }
  }
}

TEST_CASE("a rectangle takes a texel for each of its texels of area, and those that its far sides touch") {
  SceneBuilder builder;
  builder.quad({0, 0, 0}, {10.4f, 0, 0}, {0, 6.3f, 0}, builder.lambert(0.5f));
  const SurfaceAtlas atlas = makeSurfaceAtlas(builder.scene, 1.0);
  CHECK(atlas.chartCount == 1);
  CHECK(atlas.side == 11);
  REQUIRE(atlas.texels.size() == 11 * 7);
  // The places are the centres of the texels, and the nearest point where the border cuts a centre off.
  for (const AtlasTexel& texel : atlas.texels) {
    const glm::dvec3 at = place(builder.scene, texel);
    CHECK(at.x == Approx(std::min(texel.x + 0.5, 10.4)));
    CHECK(at.y == Approx(std::min(texel.y + 0.5, 6.3)));
  }
}

TEST_CASE("no point of a surface is farther from its texels than the tilt of the charts allows") {
  // Two points of one triangle in one texel are seen from the axis within sqrt(2) of each other, and are
  // within 2 on a surface tilted by 45 degrees; the texel's owner is at most 1.5 from the triangle there.
  struct Case {
    const char* name;
    Scene scene;
  };
  for (const Case& one : {Case{"room", litRoom(8, 8)}, Case{"sphere", roundSphere()},
                          Case{"spiral ramp", spiralRamp()}, Case{"loose triangles", looseTriangles()}}) {
    for (const double texelSize : {0.1, 0.02}) {
      INFO(one.name << ", texels of " << texelSize);
      CHECK(farthestGap(one.scene, makeSurfaceAtlas(one.scene, texelSize), texelSize, 20000) < 3.5);
    }
  }
}

TEST_CASE("the texels are as many as the area asks for, between the area itself and twice it") {
  const Scene sphere = roundSphere();
  const SurfaceAtlas atlas = makeSurfaceAtlas(sphere, 0.01);
  const double area = 4.0 * kPi / (0.01 * 0.01);
  // Projection shrinks areas by up to cos 45 degrees; borders add their length.
  CHECK(static_cast<double>(atlas.texels.size()) > area * std::cos(kLargestChartTilt));
  CHECK(static_cast<double>(atlas.texels.size()) < 1.1 * area);
  CHECK(atlas.chartCount >= 6);
  CHECK(atlas.chartCount < 60);
  // Shelves waste less than half of the square.
  CHECK(static_cast<double>(atlas.texels.size()) > 0.4 * atlas.side * atlas.side);
}

TEST_CASE("a surface that covers itself along the axis of its chart is cut, and a flat one is not") {
  CHECK(makeSurfaceAtlas(spiralRamp(), 0.02).chartCount >= 3);
  const Scene flat = gridOf(20, [](double u, double v) { return glm::vec3(u, 0, v); });
  CHECK(makeSurfaceAtlas(flat, 0.02).chartCount == 1);
}

TEST_CASE("the texels of a part lie on triangles of that part") {
  const Scene scene = litRoom(8, 8);
  const SurfaceAtlas atlas = makeSurfaceAtlas(scene, 0.05);
  std::size_t part = 0, texels = 0;
  for (const Object& object : scene.objects)
    for (const Part& one : object.parts) {
      const AtlasPart& range = atlas.parts.at(part++);
      CHECK(range.firstTexel == texels);
      texels += range.texelCount;
      CHECK(range.texelCount > 0);
      for (std::uint32_t i = 0; i < range.texelCount; ++i) {
        const std::uint32_t first = 3 * atlas.texels[range.firstTexel + i].triangle;
        CHECK((first >= one.firstIndex && first < one.firstIndex + one.indexCount));
      }
    }
  CHECK(part == atlas.parts.size());
  CHECK(texels == atlas.texels.size());
}

TEST_CASE("the same scene gives the same atlas") {
  const Scene scene = spiralRamp();
  const SurfaceAtlas a = makeSurfaceAtlas(scene, 0.03), b = makeSurfaceAtlas(scene, 0.03);
  CHECK(a.side == b.side);
  CHECK(a.texels == b.texels);
}

TEST_CASE("objects are measured as they are placed") {
  SceneBuilder builder;
  builder.quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, builder.lambert(0.5f)).placement =
      glm::dmat4(10, 0, 0, 0, 0, 10, 0, 0, 0, 0, 10, 0, 5, 5, 5, 1);
  CHECK(makeSurfaceAtlas(builder.scene, 1.0).texels.size() >= 100);
  CHECK(makeSurfaceAtlas(builder.scene, 1.0).texels.size() <= 121);
}

TEST_CASE("an atlas of nothing is empty, and one without bounds is refused before memory is taken") {
  CHECK(makeSurfaceAtlas(SceneBuilder().scene, 1.0).texels.empty());
  const Scene room = litRoom(8, 8);
  CHECK_THROWS_MATCHES(makeSurfaceAtlas(room, 0.0), Error, Tells("above 0"));
  CHECK_THROWS_MATCHES(makeSurfaceAtlas(room, 1e-9), Error, Tells("texels"));
}

TEST_CASE("the areas of texels sum to that of the surface, and every texel's chart is its triangle's") {
  const auto wave = [](double u, double v) {
    return glm::vec3(u, 0.2 * std::sin(9.0 * u) * std::cos(7.0 * v), v);
  };
  for (const int n : {1, 7, 60})
    for (const AtlasPlaces places : {AtlasPlaces::centres, AtlasPlaces::middles}) {
      const Scene scene = gridOf(n, wave);
      double surface = 0.0, texels = 0.0;
      for (std::uint32_t t = 0; t < scene.triangleCount(); ++t)
        surface += 0.5 * glm::length(glm::cross(corner(scene, t, 1) - corner(scene, t, 0),
                                                corner(scene, t, 2) - corner(scene, t, 0)));
      const SurfaceAtlas atlas = makeSurfaceAtlas(scene, {0.043}, places);
      for (const AtlasTexel& texel : atlas.texels) {
        texels += static_cast<double>(texel.area);
        CHECK(texel.chart < atlas.chartCount);
        CHECK(texel.chart == atlas.chartOfTriangle[texel.triangle]);
      }
      CHECK(texels == Approx(surface).epsilon(1e-4));
    }
}

TEST_CASE("an object has texels of its own size; placed at middles they fill a rectangle evenly") {
  Scene scene = gridOf(1, [](double u, double v) { return glm::vec3(u, 0, v); });
  addTriangles(scene, {{3, 0, 0}, {3, 0, 1}, {4, 0, 1}, {4, 0, 0}}, {0, 1, 2, 0, 2, 3});
  const SurfaceAtlas atlas = makeSurfaceAtlas(scene, {0.21, 0.07}, AtlasPlaces::middles);
  // 4.8 texels a side are made 4, and 14.3 are made 16 or 12: the nearest multiple of 2 or 4.
  CHECK(atlas.parts[0].texelCount == 16);
  CHECK(atlas.parts[1].texelCount == 256);
  for (std::uint32_t i = 0; i < 16; ++i) {
    const AtlasTexel& texel = atlas.texels[i];
    CHECK(static_cast<double>(texel.area) == Approx(1.0 / 16.0).epsilon(1e-6));
    const glm::dvec3 at = place(scene, texel);
    for (const double along : {4.0 * at.x, 4.0 * at.z})
      CHECK(along - std::floor(along) == Approx(0.5).margin(1e-5));
  }
}

TEST_CASE("outlines tile a flat piece of surface, at borders that cut texels and over many triangles") {
  // Fronts are seen from above: x, then -z, is counter-clockwise.
  const auto shear = [](double u, double v) { return glm::vec3(2.0 * u + 0.3 * v, 0, -0.7 * v - 0.45 * u); };
  SceneBuilder triangle, disc;
  triangle.mesh({{0, 0, 0}, {1.3f, 0, -0.2f}, {0.4f, 0, -1.1f}}, triangle.lambert(0.5f));
  std::vector<glm::vec3> places{{0, 0, 0}};
  std::vector<std::uint32_t> corners;
  constexpr std::uint32_t kSectors = 64;
  for (std::uint32_t i = 0; i < kSectors; ++i) {
    const double angle = 2.0 * kPi * i / kSectors;
    places.emplace_back(std::cos(angle), 0.0, -std::sin(angle));
    corners.insert(corners.end(), {0, 1 + i, 1 + (i + 1) % kSectors});
  }
  addTriangles(disc.scene, places, corners);
  const double discArea = 0.5 * kSectors * std::sin(2.0 * kPi / kSectors);
  for (const double size : {0.07, 0.3, 0.9}) {
    CAPTURE(size);
    for (const auto& [scene, area] : {std::pair(gridOf(1, shear), 1.265),
                                      {gridOf(7, shear), 1.265},
                                      {triangle.scene, 0.675},
                                      {disc.scene, discArea}}) {
      CAPTURE(area);
      const Tiling tiling = tilingOf(scene, size);
      CHECK(tiling.area == Approx(area).epsilon(1e-5));
      // With so large texels a piece of the disc's border has more corners than are kept.
      if (size > 0.5 && area == discArea) continue;
      CHECK(tiling.holes == 0);
      CHECK(tiling.overlaps == 0);
    }
  }
}

TEST_CASE("an outline has the area of its surface where that is not convex") {
  // A square without a quarter, in one texel.
  SceneBuilder builder;
  addTriangles(builder.scene,
               {{0, 0, 0}, {1, 0, 0}, {1, 0, -0.5f}, {0.5f, 0, -0.5f}, {0.5f, 0, -1}, {0, 0, -1}},
               {0, 1, 2, 0, 2, 3, 0, 3, 4, 0, 4, 5});
  CHECK(tilingOf(builder.scene, 3.0).area == Approx(0.75).epsilon(1e-5));
}

TEST_CASE("an outline is larger by what its surface bends, up to a disc's area, beyond which there is none") {
  // A roof whose ridge lies at x = 5/6, in the middle of the third of six columns, of slopes that one chart
  // holds.
  constexpr double kTexel = 0.3, kRidge = 5.0 / 6.0;
  CHECK(std::pow(1.0 + AtlasOutline::kOverlap * AtlasOutline::kMostBend, 2.0) ==
        Approx(0.5 * kPi).epsilon(0.01));
  for (const double slope : {0.0, 0.01, 0.2}) {
    const Scene scene = gridOf(2, [&](double u, double v) {
      const double x = u < 0.5 ? 2.0 * kRidge * u : kRidge + 2.0 * (2.0 - kRidge) * (u - 0.5);
      return glm::vec3(x, slope * (1.0 - std::abs(x - kRidge)), -v);
    });
    const SurfaceAtlas atlas = makeSurfaceAtlas(scene, {kTexel}, AtlasPlaces::middles);
    CAPTURE(slope);
    REQUIRE(atlas.chartCount == 1);
    REQUIRE(atlas.outlines.size() == atlas.texels.size());
    const double most = slope / std::sqrt(1.0 + slope * slope);  // sine of the slope
    double largest = 1.0;
    std::size_t bent = 0;
    for (std::size_t i = 0; i < atlas.texels.size(); ++i) {
      const AtlasTexel& texel = atlas.texels[i];
      const AtlasOutline& outline = atlas.outlines[i];
      CAPTURE(slope, i);
      double area = 0.0;
      for (std::uint32_t k = 0; k < outline.count; ++k) {
        const glm::dvec2 p(outline.corners[k]), q(outline.corners[(k + 1) % outline.count]);
        area += 0.5 * (p.x * q.y - p.y * q.x);
      }
      const glm::dvec3 first = corner(scene, texel.triangle, 0);
      const double ratio = area / static_cast<double>(texel.area) *
                           glm::length(glm::cross(corner(scene, texel.triangle, 1) - first,
                                                  corner(scene, texel.triangle, 2) - first));
      if (std::abs(ratio - 1.0) < 1e-4) continue;
      ++bent;
      CHECK(std::abs(place(scene, texel).x - kRidge) < kTexel);
      if (outline.count == 0) continue;
      CHECK(ratio > 1.0);
      CHECK(ratio <= std::pow(1.0 + AtlasOutline::kOverlap * most, 2.0) + 1e-4);
      largest = std::max(largest, ratio);
    }
    CAPTURE(slope, bent, atlas.texels.size(), largest);
    CHECK((bent > 0) == (slope > 0.0));
    CHECK(2 * bent < atlas.texels.size());
    // A ridge in the middle bends its texel's normals by the whole slope.
    if (slope > 0.0) CHECK(largest > 1.0 + 1.7 * AtlasOutline::kOverlap * most);
  }
  // Folds, a tenth of a texel each: the sine of the slope is 0.2 or 0.37 everywhere.
  for (const double slope : {0.2, 0.4}) {
    const Scene scene = gridOf(60, [&](double u, double v) {
      const double fold = 30.0 * u - std::floor(30.0 * u);
      return glm::vec3(2.0 * u, slope / 15.0 * std::min(fold, 1.0 - fold), -v);
    });
    const SurfaceAtlas atlas = makeSurfaceAtlas(scene, {kTexel}, AtlasPlaces::middles);
    REQUIRE(atlas.chartCount == 1);
    for (const AtlasOutline& outline : atlas.outlines) CHECK((outline.count == 0) == (slope > 0.3));
  }
}
