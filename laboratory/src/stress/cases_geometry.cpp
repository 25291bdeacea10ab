// Geometry at its extremes: none, slivers, duplicates, crowds, walls thinner than a voxel, and empty grids.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lumivox/base/error.h"
#include "lumivox/base/low_discrepancy.h"
#include "stress/cases.h"
#include "stress/measures.h"
#include "stress/pass_parameters.h"
#include "stress/scene_pieces.h"

namespace lumivox::stress {
namespace {

constexpr const char* kGeometryFamily = "geometry";

std::optional<Finding> noTriangles(Bench& bench) {
  Scene scene = bench.committedScene("stress/no_triangles");
  if (!makesImages(bench)) {
    const auto error = bench.voxelError(scene);
    if (!error) return std::nullopt;
    return judged("voxels set", {static_cast<double>(error->falsePositive), 0.0}, 0.0);
  }
  const Frame sky = bench.render(scene);
  if (sky.whole.empty()) return withoutLight();
  ImageBuffer wanted = sky.whole;
  for (int y = 0; y < wanted.height(); ++y)
    for (int x = 0; x < wanted.width(); ++x)
      for (int c = 0; c < wanted.channels(); ++c) wanted.at(x, y, c) = c < 3 ? scene.environment[c] : 1.0f;
  scene.environment = glm::vec3(0.0f);
  scene.hash = {};
  const double inTheDark = largestOf(bench.render(scene).whole);
  bench.show(sky.whole);
  return judged("RMS difference from the environment, of it, and the largest radiance without one",
                {std::max(relativeDifference(sky.whole, wanted), inTheDark), 0.0}, 0.0);
}

std::optional<Finding> oneTriangle(Bench& bench) {
  const Scene scene = bench.committedScene("stress/one_triangle");
  if (!makesImages(bench)) {
    const auto error = bench.voxelError(scene);
    if (!error) return std::nullopt;
    return judged("share of wrong voxels", {wrongShare(*error), 0.0}, 0.01);
  }
  const Frame frame = bench.render(scene);
  if (frame.whole.empty()) return withoutLight();
  if (!makesIndirect(frame)) return againstReference(bench, scene, 0.05);
  // A flat surface cannot light itself.
  const double direct = meanOf(frame.whole) - meanOf(indirectOf(frame));
  return judged("light of a triangle on itself, as a share of its direct light",
                {meanOf(indirectOf(frame)) / direct, 0.0}, 0.01);
}

/// The loader drops triangles without area; a sliver of 0.1 mm stays, too thin to be seen.
std::optional<Finding> degenerate(Bench& bench) {
  const Scene scene = bench.committedScene("stress/degenerate");
  Scene floor = scene;
  floor.hash = {};
  floor.objects.clear();
  SceneBuilder builder;
  builder.scene = floor;
  builder.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, scene.objects.front().parts.front().material);
  return sameAs(bench, builder.scene, scene, 0.01, "the floor without the slivers");
}

/// Needles of half a metre throughout the free space of a room, in all directions.
Scene roomWithNeedles() {
  constexpr int kCount = 64;
  constexpr double kLength = 0.5, kThickness = 1e-6 * kLength;
  SceneBuilder builder = closedRoom(0.7f);
  std::vector<glm::vec3> corners;
  for (int i = 0; i < kCount; ++i) {
    const auto [u, v] = r2Point(i + 1);
    const auto [a, b] = r2Point(i + 1 + kCount);
    const glm::dvec3 middle(0.3 + 0.4 * u, 0.3 + 0.4 * v, 0.3 + 0.4 * a);
    const double turn = 2.0 * std::numbers::pi * b, cosTilt = 2.0 * u - 1.0,
                 sinTilt = std::sqrt(1.0 - cosTilt * cosTilt);
    const glm::dvec3 along(sinTilt * std::cos(turn), cosTilt, sinTilt * std::sin(turn));
    const glm::dvec3 helper = std::abs(along.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
    corners.emplace_back(middle - 0.5 * kLength * along);
    corners.emplace_back(middle + 0.5 * kLength * along);
    corners.emplace_back(middle + kThickness * glm::normalize(glm::cross(along, helper)));
  }
  builder.mesh(corners, builder.lambert(0.7f));
  return builder.scene;
}

std::optional<Finding> needles(Bench& bench) {
  return sameAs(bench, closedRoom(0.7f).scene, roomWithNeedles(), 0.01, "the room without the needles");
}

std::optional<Finding> duplicates(Bench& bench) {
  const Scene scene = bench.committedScene("cornell");
  return sameAs(bench, scene, doubled(scene), 1e-3, "the scene with every triangle once");
}

std::optional<Finding> overlapping(Bench& bench) {
  const auto floorOf = [](const std::vector<std::pair<glm::vec2, glm::vec2>>& patches) {
    SceneBuilder builder = openFloor();
    builder.light(LightKind::directional, glm::vec3(3.0f), {}, {-0.3, -1.0, -0.4});
    const int grey = builder.lambert(0.5f);
    for (const auto& [low, high] : patches)
      builder.quad({low.x, -0.2f, low.y}, {0, 0, high.y - low.y}, {high.x - low.x, 0, 0}, grey);
    return builder.scene;
  };
  // The pieces cover the same square up to four times.
  return sameAs(bench, floorOf({{{-1.5f, -1.5f}, {1.5f, 1.5f}}}),
                floorOf({{{-1.5f, -1.5f}, {0.7f, 1.5f}},
                         {{-0.9f, -1.5f}, {1.5f, 1.5f}},
                         {{-1.5f, -1.5f}, {1.5f, 0.6f}},
                         {{-1.5f, -0.8f}, {1.5f, 1.5f}}}),
                1e-3, "the square in one piece");
}

std::optional<Finding> wallLeak(Bench& bench, float wall) {
  const Scene scene = twoRooms(wall);
  Shot dark, lit;
  dark.camera = "dark";
  lit.camera = "lit";
  return leak(bench, scene, dark, scene, lit, "in the dark room, of that in the lit one", 0.01);
}

std::optional<Finding> crowdedVoxel(Bench& bench) {
  constexpr int kCells = 188;
  static_assert(2 * kCells * kCells > 65536);
  return sameAs(bench, glowingSpeck(1), glowingSpeck(kCells), 1e-3, "the speck of two triangles");
}

std::optional<Finding> millionTriangles(Bench& bench) {
  const auto floorOf = [](int cells) {
    SceneBuilder builder = openFloor();
    builder.light(LightKind::directional, glm::vec3(3.0f), {}, {-0.3, -1.0, -0.4});
    builder.mesh(gridOfTriangles({-1.5f, -0.2f, -1.5f}, {0, 0, 3}, {3, 0, 0}, cells, cells),
                 builder.lambert(0.5f));
    return builder.scene;
  };
  constexpr int kCells = 708;
  static_assert(2 * kCells * kCells > 1000000);
  return sameAs(bench, floorOf(1), floorOf(kCells), 0.01, "the floor of two triangles");
}

/// Two squares of 1 m that meet at an angle of 1 degree, lit by a sun that shines straight into the gap, so
/// that both have the same irradiance everywhere: pi. The camera looks into the gap from its mouth.
Scene wedge(float albedo) {
  constexpr double kHalf = 0.5 * std::numbers::pi / 180.0;
  const glm::vec3 lower(std::cos(kHalf), -std::sin(kHalf), 0.0), upper(std::cos(kHalf), std::sin(kHalf), 0.0);
  SceneBuilder builder;
  const int grey = builder.lambert(albedo);
  builder.quad({0, 0, -0.5}, {0, 0, 1}, lower, grey);
  builder.quad({0, 0, -0.5}, upper, {0, 0, 1}, grey);
  builder.light(LightKind::directional, glm::vec3(std::numbers::pi / std::sin(kHalf)), {}, {-1, 0, 0});
  builder.look({1.5, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0, 1, 0}, 0.03, 64, 64);
  return builder.scene;
}

std::optional<Finding> acuteWedge(Bench& bench) {
  if (!makesImages(bench)) return std::nullopt;
  constexpr float kAlbedo = 0.7f;
  const Scene scene = wedge(kAlbedo);
  const Frame frame = bench.render(scene);
  if (frame.whole.empty()) return withoutLight();
  // Every surface reflects `kAlbedo`, so that a bounce passes on at most that share.
  double bound = kAlbedo, bounce = kAlbedo;
  int bounces = 0;
  if (makesIndirect(frame))
    for (const auto& [output, modelled] : frame.result.indirectBounces) bounces = std::max(bounces, modelled);
  for (int i = 0; i < bounces; ++i) bound += bounce *= kAlbedo;
  std::string detail;
  if (makesIndirect(frame))
    detail = fmt::format("mean of the indirect light, of that of an endless wedge: {:.3g}",
                         meanOf(indirectOf(frame)) / (bound - kAlbedo));
  // Half a percent of rounding of textures of half floats.
  return judged("largest radiance, of the most that so many bounces can bring",
                {largestOf(frame.whole) / bound, 0.0}, 1.005, detail);
}

std::optional<Finding> manyObjects(Bench& bench) {
  constexpr int kSide = 128;
  static_assert(kSide * kSide == 16384);
  const glm::vec3 corner(-1.5f, -0.2f, -1.5f), edge1(0, 0, 3), edge2(3, 0, 0);
  const auto floorOf = [&](bool separate) {
    SceneBuilder builder = openFloor();
    builder.light(LightKind::directional, glm::vec3(3.0f), {}, {-0.3, -1.0, -0.4});
    const int grey = builder.lambert(0.5f);
    if (!separate) builder.mesh(gridOfTriangles(corner, edge1, edge2, kSide, kSide), grey);
    for (int i = 0; separate && i < kSide * kSide; ++i)
      builder.quad(corner + (static_cast<float>(i % kSide) * edge1 + static_cast<float>(i / kSide) * edge2) /
                                static_cast<float>(kSide),
                   edge1 / static_cast<float>(kSide), edge2 / static_cast<float>(kSide), grey);
    return builder.scene;
  };
  return sameAs(bench, floorOf(false), floorOf(true), 0.01, "the squares as one mesh");
}

Scene sunlitFloor() {
  SceneBuilder builder = openFloor();
  builder.light(LightKind::directional, glm::vec3(3.0f), {}, {-0.3, -1.0, -0.4});
  return builder.scene;
}

std::optional<Finding> sealedCamera(Bench& bench) {
  const Scene lit = sunlitFloor();
  SceneBuilder builder = openFloor();
  builder.scene = lit;
  const glm::vec3 eye(lit.camera().eye);
  builder.box(eye - 0.1f, eye + 0.1f, builder.lambert(0.7f), false);
  return leak(bench, builder.scene, {}, lit, {}, "in a closed box around the camera, of that without it",
              0.01);
}

std::optional<Finding> farSpeck(Bench& bench) {
  const Scene scene = sunlitFloor();
  SceneBuilder builder = openFloor();
  builder.scene = scene;
  builder.mesh({{-1000, 0, 0}, {-1000, 0, 0.01f}, {-1000, 0.01f, 0}}, 0);
  return sameAs(bench, scene, builder.scene, 0.01, "the scene without the speck");
}

std::optional<Finding> openAgainstClosed(Bench& bench) {
  if (!makesImages(bench)) return std::nullopt;
  const Scene closed = closedRoom(0.7f).scene;
  Scene open = closed;
  // The walls behind the camera, which it does not see: those at high z and high x.
  open.objects.erase(open.objects.begin() + 5);
  open.objects.erase(open.objects.begin() + 1);
  const Frame closedFrame = bench.render(closed), openFrame = bench.render(open);
  if (openFrame.whole.empty()) return withoutLight();
  if (!makesIndirect(closedFrame))
    return judged("change of the direct light, which does not know the walls, of it",
                  {relativeDifference(openFrame.whole, closedFrame.whole), 0.0}, 1e-3);
  const double left = meanOf(indirectOf(openFrame)) / meanOf(indirectOf(closedFrame));
  const double wanted =
      indirectReference(bench, open, openFrame) / indirectReference(bench, closed, closedFrame);
  return judged("share of the indirect light that opening two walls takes, beside the same of the reference",
                {std::abs(left - wanted), 0.0}, 0.1,
                fmt::format("taken: {:.3g}; from the reference: {:.3g}", 1.0 - left, 1.0 - wanted));
}

/// Places all grids that can follow the camera around it, with this side; nullopt where none can.
std::optional<Shot> withGridsAroundCamera(Bench& bench, double extent) {
  Shot shot;
  for (const PassParameter& one : freePassParameters(bench.pipeline(), bench.techniques())) {
    const std::string parameter = one.name.substr(one.name.find('.') + 1);
    if (parameter == "around") shot.passParameters[one.name].word = "camera";
    if (parameter == "extent") shot.passParameters[one.name].number = extent;
  }
  return shot.passParameters.empty() ? std::nullopt : std::optional(shot);
}

std::optional<Finding> outsideTheGrid(Bench& bench) {
  const std::optional<Shot> around = withGridsAroundCamera(bench, 0.1);
  if (!around) return std::nullopt;
  const Shot& shot = *around;
  const Scene scene = sunlitFloor();
  if (!makesImages(bench)) {
    const auto error = bench.voxelError(scene, shot);
    if (!error) return std::nullopt;
    return judged("voxels set", {static_cast<double>(error->falsePositive), 0.0}, 0.0);
  }
  const Frame frame = bench.render(scene, shot);
  if (frame.whole.empty()) return withoutLight();
  if (!makesIndirect(frame)) return std::nullopt;
  return judged("indirect light from a grid that nothing lies in, of all light",
                {meanOf(indirectOf(frame)) / meanOf(frame.whole), 0.0}, 0.0);
}

}  // namespace

std::vector<Case> geometryCases() {
  const auto info = [](const char* name, const char* meaning, bool quick) {
    return StressCaseInfo{kGeometryFamily, name, meaning, quick};
  };
  return {
      {info("no_triangles", "no triangle at all: the image is the environment, without one exactly black",
            true),
       noTriangles},
      {info("one_triangle", "one triangle, which cannot light itself", false), oneTriangle},
      {info("degenerate_triangles",
            "a point, a line and a sliver of 0.1 mm over a floor change nothing that could be seen", true),
       degenerate},
      {info("needle_triangles", "64 needles of 1 : 10^6 in a room change nothing that could be seen", false),
       needles},
      {info("coplanar_duplicates", "every surface twice in the same place: the same image", true),
       duplicates},
      {info("overlapping_triangles", "a surface in pieces that overlap: the same image as in one piece",
            false),
       overlapping},
      {info("thin_wall_leak",
            "two closed rooms with a wall of 1 cm between them, thinner than a voxel: no light gets through",
            true),
       [](Bench& bench) { return wallLeak(bench, 0.01f); }},
      {info("sheet_wall_leak", "two closed rooms with a single sheet between them: no light gets through",
            false),
       [](Bench& bench) { return wallLeak(bench, 0.0f); }},
      {info("crowded_voxel",
            "70,688 triangles in one voxel: the same light as from two triangles of the same surface", true),
       crowdedVoxel},
      {info("sealed_camera", "a closed box around the camera, the light outside: black", false),
       sealedCamera},
      {info("million_triangles", "a floor of a million tiny triangles: the image of two large ones", false),
       millionTriangles},
      {info("acute_wedge", "two planes at an angle of 1 degree: no more light than so many bounces can bring",
            true),
       acuteWedge},
      {info("many_objects", "16,384 squares, each an object of its own: the image of one mesh of them",
            false),
       manyObjects},
      {info("far_speck", "a speck a kilometre away makes voxels huge, and changes nothing that could be seen",
            false),
       farSpeck},
      {info("outside_the_grid",
            "a grid of 10 cm around a camera in mid-air: all surfaces lie outside of it, and nothing bounces",
            false),
       outsideTheGrid},
      {info("open_against_closed", "a room loses two walls: as much light is lost as in the reference",
            false),
       openAgainstClosed},
  };
}

}  // namespace lumivox::stress
