// The same scene in other units, at other places, turned; grids of awkward resolutions.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "stress/cases.h"
#include "stress/measures.h"
#include "stress/scene_pieces.h"

namespace lumivox::stress {
namespace {

constexpr const char* kScaleAndPlaceFamily = "scale_and_place";

/// The lower half of the Cornell box, its light out of view, with something glossy and thin fog; in the full
/// battery with one more light of every kind that has a place: every length that some technique uses is in
/// it.
Scene room(const Bench& bench, bool fog) {
  Scene scene = bench.committedScene("cornell");
  scene.hash = {};
  // So that no pixel of either size has its centre on an edge, where rounding would decide what it sees.
  scene.cameras.front().target = {0.2739, 0.1431, 0.0};
  scene.cameras.front().fov = glm::radians(28.3);
  if (!bench.quick()) {
    Light light;
    light.name = "light";
    light.kind = LightKind::point;
    light.position = {0.15, 0.35, 0.2};
    light.power = glm::vec3(0.15f);
    scene.lights.push_back(light);
    Light spot;
    spot.name = "spot";
    spot.kind = LightKind::spot;
    spot.position = {0.45, 0.5, 0.1};
    spot.direction = glm::normalize(glm::dvec3(-0.3, -0.5, 0.25));
    spot.power = glm::vec3(0.3f);
    spot.innerAngle = glm::radians(15.0f);
    spot.outerAngle = glm::radians(25.0f);
    scene.lights.push_back(spot);
  }
  for (Material& material : scene.materials) {
    if (material.emissive()) continue;
    material.specular = glm::vec3(0.1f);
    material.exponent = 10.0f;
  }
  if (fog) {
    Medium medium;
    medium.name = "fog";
    medium.extinction = glm::vec3(0.5f);
    medium.albedo = glm::vec3(0.8f);
    medium.anisotropy = 0.3f;
    medium.box = {{0.05, 0.05, 0.05}, {0.5, 0.5, 0.5}};
    scene.media.push_back(medium);
  }
  return scene;
}

std::optional<Finding> movedBy(Bench& bench, const Similarity& by, double limit, const std::string& what) {
  const Scene scene = room(bench, true);
  return sameAs(bench, scene, moved(scene, by), limit, what);
}

std::optional<Finding> scaled(Bench& bench, double scale) {
  Similarity by;
  by.scale = scale;
  return movedBy(bench, by, 0.005, "the same scene in metres");
}

std::optional<Finding> movedAway(Bench& bench, double distance) {
  Similarity by;
  by.translation = {distance, 0.0, -distance};
  return movedBy(bench, by, 0.01, "the same scene at the origin");
}

std::optional<Finding> quarterTurn(Bench& bench) {
  Similarity by;
  by.rotation = turnAboutY(0.5 * std::numbers::pi);
  return movedBy(bench, by, 0.01, "the same scene unturned");
}

/// Not the same image: walls lie at a slant in the grid. Its light must stay what it was.
std::optional<Finding> turnedBy30(Bench& bench) {
  const Scene scene = room(bench, false);
  Similarity by;
  by.rotation = turnAboutY(std::numbers::pi / 6.0);
  const Scene turned = moved(scene, by);
  if (!makesImages(bench)) return sameAs(bench, scene, turned, 0.05, "the same scene unturned");
  const Frame straight = bench.render(scene), slanted = bench.render(turned);
  if (straight.whole.empty()) return std::nullopt;
  const bool indirect = makesIndirect(straight);
  const double ratio = indirect ? meanOf(indirectOf(slanted)) / meanOf(indirectOf(straight))
                                : meanOf(slanted.whole) / meanOf(straight.whole);
  return judged(fmt::format("change of the {} light's mean", indirect ? "indirect" : "whole"),
                {std::abs(ratio - 1.0), 0.0}, 0.1,
                fmt::format("RMS difference of the images {:.3g} of the mean",
                            relativeDifference(slanted.whole, straight.whole)));
}

Shot atResolution(int resolution) {
  Shot shot;
  shot.parameters["resolution"].number = resolution;
  return shot;
}

/// Voxels, against those of the exact test, beside the same at 64.
std::optional<Finding> gridOfVoxels(Bench& bench, const Scene& scene, int resolution) {
  const auto fine = bench.voxelError(scene, atResolution(64)),
             error = bench.voxelError(scene, atResolution(resolution));
  if (!fine || !error) return std::nullopt;
  return judged("share of wrong voxels beyond that of 64",
                {std::max(wrongShare(*error) - wrongShare(*fine), 0.0), 0.0}, 0.05,
                fmt::format("wrong: {:.3g}; at 64: {:.3g}", wrongShare(*error), wrongShare(*fine)));
}

/// A grid too coarse to show anything, or very fine, still knows how much light there is.
std::optional<Finding> gridAgainstReference(Bench& bench, int resolution) {
  if (bench.parameter("resolution") == nullptr) return std::nullopt;
  if (!makesImages(bench)) return gridOfVoxels(bench, bench.committedScene("cornell"), resolution);
  const Scene scene = room(bench, false);
  const Shot shot = atResolution(resolution);
  const Frame frame = bench.render(scene, shot);
  if (!makesIndirect(frame)) return std::nullopt;
  const double ratio = meanOf(indirectOf(frame)) / indirectReference(bench, scene, frame);
  return judged("distance of the indirect light's mean from the reference's, of it",
                {std::abs(ratio - 1.0), 0.0}, 0.25, fmt::format("{:.3g} of the reference's", ratio));
}

/// One voxel more or less changes little.
std::optional<Finding> gridBeside64(Bench& bench, int resolution) {
  if (bench.parameter("resolution") == nullptr) return std::nullopt;
  if (!makesImages(bench)) return gridOfVoxels(bench, bench.committedScene("cornell"), resolution);
  const Scene scene = room(bench, false);
  const Frame at64 = bench.render(scene, atResolution(64)),
              beside = bench.render(scene, atResolution(resolution));
  if (at64.whole.empty()) return std::nullopt;
  return judged("RMS difference from a grid of 64, of its mean",
                {relativeDifference(beside.whole, at64.whole), 0.0}, 0.05,
                fmt::format("of the indirect light alone {:.3g}",
                            relativeDifference(indirectOf(beside), indirectOf(at64))));
}

}  // namespace

std::vector<Case> scaleAndPlaceCases() {
  const auto info = [](std::string name, std::string meaning, bool quick) {
    return StressCaseInfo{kScaleAndPlaceFamily, std::move(name), std::move(meaning), quick};
  };
  std::vector<Case> cases{
      {info("scale_0.001", "the same scene in millimetres: the same image", true),
       [](Bench& bench) { return scaled(bench, 1e-3); }},
      {info("scale_1000", "the same scene in kilometres: the same image", false),
       [](Bench& bench) { return scaled(bench, 1e3); }},
      {info("moved_10_km", "scene and camera ten kilometres from the origin: the same image", false),
       [](Bench& bench) { return movedAway(bench, 1e4); }},
      {info("moved_1000_km", "scene and camera a thousand kilometres from the origin: the same image", true),
       [](Bench& bench) { return movedAway(bench, 1e6); }},
      {info("turned_90", "scene and camera turned by 90 degrees about Y: the same image", true), quarterTurn},
      {info(
           "turned_30",
           "scene and camera turned by 30 degrees about Y: walls lie at a slant in the grid, but light stays",
           false),
       turnedBy30},
  };
  for (const int resolution : {1, 2, 3, 64, 256})
    cases.push_back(
        {info(
             fmt::format("grid_{}", resolution),
             fmt::format(
                 "a grid of {} along its longest side: the mean of the indirect light against the reference; "
                 "voxels against the exact test",
                 resolution),
             resolution == 1),
         [resolution](Bench& bench) { return gridAgainstReference(bench, resolution); }});
  for (const int resolution : {63, 65})
    cases.push_back(
        {info(fmt::format("grid_{}", resolution),
              fmt::format(
                  "a grid of {} along its longest side, which is not a power of two: nearly the image of 64",
                  resolution),
              false),
         [resolution](Bench& bench) { return gridBeside64(bench, resolution); }});
  return cases;
}

}  // namespace lumivox::stress
