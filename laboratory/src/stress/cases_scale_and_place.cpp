// The same scene in other units, at other places and turned; grids of awkward resolutions.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lumivox/base/error.h"
#include "stress/cases.h"
#include "stress/measures.h"
#include "stress/pass_parameters.h"
#include "stress/scene_pieces.h"

namespace lumivox::stress {
namespace {

constexpr const char* kScaleAndPlaceFamily = "scale_and_place";

/// The lower half of the Cornell box with its light out of view, something glossy and thin fog; in the full
/// battery also with a light of every kind that has a position. It contains every length that techniques use.
Scene room(const Bench& bench, bool fog) {
  Scene scene = bench.committedScene("cornell");
  scene.hash = {};
  // Keeps the centres of pixels of both sizes off edges, where rounding would decide what they see.
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

/// The image may change, since walls lie at a slant in the grid, but its light must not.
std::optional<Finding> turnedBy30(Bench& bench) {
  const Scene scene = room(bench, false);
  Similarity by;
  by.rotation = turnAboutY(std::numbers::pi / 6.0);
  const Scene turned = moved(scene, by);
  if (!makesImages(bench)) return sameAs(bench, scene, turned, 0.05, "the same scene unturned");
  const Frame straight = bench.render(scene), slanted = bench.render(turned);
  const bool indirect = makesIndirect(straight);
  const double ratio = indirect ? meanOf(indirectOf(slanted)) / meanOf(indirectOf(straight))
                                : meanOf(slanted.compared) / meanOf(straight.compared);
  const char* const what = indirect                 ? "indirect light's"
                           : straight.whole.empty() ? "image's"
                                                    : "whole light's";
  return judged(fmt::format("change of the {} mean", what), {std::abs(ratio - 1.0), 0.0}, 0.1,
                fmt::format("RMS difference of the images {:.3g} of the mean",
                            relativeDifference(slanted.compared, straight.compared)));
}

Shot atResolution(int resolution) {
  Shot shot;
  shot.parameters["resolution"].number = resolution;
  return shot;
}

Finding withoutResolution() {
  return notApplicable("it has no parameter 'resolution'");
}

/// Compares voxels with the exact test, beside the same comparison at 64.
std::optional<Finding> gridOfVoxels(Bench& bench, const Scene& scene, int resolution) {
  const auto fine = bench.voxelError(scene, atResolution(64)),
             error = bench.voxelError(scene, atResolution(resolution));
  if (!fine || !error) return std::nullopt;
  return judged("share of wrong voxels beyond that of 64",
                {std::max(wrongShare(*error) - wrongShare(*fine), 0.0), 0.0}, 0.05,
                fmt::format("wrong: {:.3g}; at 64: {:.3g}", wrongShare(*error), wrongShare(*fine)));
}

/// A very coarse or very fine grid must still hold the right amount of light.
std::optional<Finding> gridAgainstReference(Bench& bench, int resolution) {
  if (bench.parameter("resolution") == nullptr) return withoutResolution();
  if (!makesImages(bench)) return gridOfVoxels(bench, bench.committedScene("cornell"), resolution);
  const Scene scene = room(bench, false);
  const Shot shot = atResolution(resolution);
  const Frame frame = bench.render(scene, shot);
  if (!makesIndirect(frame)) return notApplicable("it makes no indirect light");
  const double ratio = meanOf(indirectOf(frame)) / indirectReference(bench, scene, frame);
  return judged("distance of the indirect light's mean from the reference's, of it",
                {std::abs(ratio - 1.0), 0.0}, 0.25, fmt::format("{:.3g} of the reference's", ratio));
}

/// One voxel more or less changes little.
std::optional<Finding> gridBeside64(Bench& bench, int resolution) {
  if (bench.parameter("resolution") == nullptr) return withoutResolution();
  if (!makesImages(bench)) return gridOfVoxels(bench, bench.committedScene("cornell"), resolution);
  const Scene scene = room(bench, false);
  const Frame at64 = bench.render(scene, atResolution(64)),
              beside = bench.render(scene, atResolution(resolution));
  return judged("RMS difference from a grid of 64, of its mean",
                {relativeDifference(beside.compared, at64.compared), 0.0}, 0.05,
                fmt::format("of the indirect light alone {:.3g}",
                            relativeDifference(indirectOf(beside), indirectOf(at64))));
}

// ---- walls and voxels ------------------------------------------------------------------------------------

/// The grid of the largest cubic voxels that passes fill; nullopt where no pass fills any.
std::optional<VoxelBox> coarsestGrid(const Frame& frame) {
  std::optional<VoxelBox> coarsest;
  for (const VoxelBox& grid : frame.grids) {
    const glm::dvec3& size = grid.voxelSize;
    if (!(size.x > 0.0) || std::abs(size.y / size.x - 1.0) > 1e-6 || std::abs(size.z / size.x - 1.0) > 1e-6)
      continue;
    if (!coarsest || size.x > coarsest->voxelSize.x) coarsest = grid;
  }
  return coarsest;
}

/// Distance in voxels, from 0 to 0.5, to the nearest face, for the wall whose distance differs most from
/// `wanted`.
double offFaces(const VoxelBox& grid, const WallRoom& room, double wanted) {
  double worst = wanted;
  for (const double end : {0.0, room.size})
    for (int axis = 0; axis < 3; ++axis) {
      const double place = (room.low[axis] + end - grid.low[axis]) / grid.voxelSize[axis];
      const double off = std::abs(place - std::round(place));
      if (std::abs(off - wanted) > std::abs(worst - wanted)) worst = off;
    }
  return worst;
}

/// Share of the walls' cells, squares of a voxel's side, without an occupied voxel; for a wall in a face, on
/// neither side.
double missedShare(const OccupiedVoxels& occupied, const WallRoom& room) {
  constexpr double kRounding = 1e-3;  // voxels
  const glm::dvec3 low =
      (room.low - glm::dvec3(occupied.grid.low)) / static_cast<double>(occupied.grid.voxelSize);
  const double size = room.size / occupied.grid.voxelSize;
  std::size_t missed = 0, cells = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (const double wall : {low[axis], low[axis] + size}) {
      const int next = (axis + 1) % 3, last = (axis + 2) % 3;
      glm::ivec3 voxel;
      const auto first = [&](int along) { return static_cast<int>(std::ceil(low[along] - 0.5 + kRounding)); };
      const auto isWithin = [&](int along) { return voxel[along] + 0.5 < low[along] + size - kRounding; };
      for (voxel[next] = first(next); isWithin(next); ++voxel[next])
        for (voxel[last] = first(last); isWithin(last); ++voxel[last]) {
          ++cells;
          bool found = false;
          for (const double side : {-kRounding, kRounding}) {
            voxel[axis] = static_cast<int>(std::floor(wall + side));
            found = found || occupied.voxels.contains(voxel);
          }
          missed += found ? 0 : 1;
        }
    }
  return cells == 0 ? 0.0 : static_cast<double>(missed) / static_cast<double>(cells);
}

/// A room whose walls lie in faces of voxels, up to single precision, compared with the same room half a
/// voxel further along each axis in the same grid.
std::optional<Finding> wallsInFaces(Bench& bench) {
  constexpr double kWanted = 0.9;  // m, of the room
  Shot shot;
  shot.keepEverything = true;
  shot.width = shot.height = 8;
  const std::optional<VoxelBox> grid =
      coarsestGrid(bench.render(roomInBounds({glm::dvec3(-0.5 * kWanted), kWanted}), shot));
  shot.width = shot.height = bench.quick() ? 32 : 0;
  if (!grid) return notApplicable("no pass of it makes a grid of voxels");
  const double voxel = grid->voxelSize.x;
  const double count = std::floor(kWanted / voxel);
  if (count < 2.0)
    return notApplicable(fmt::format("its voxels of {:.2g} m are as large as the room", voxel));
  WallRoom inFaces{glm::dvec3(0.0), count * voxel}, halfOff;
  for (int axis = 0; axis < 3; ++axis)
    inFaces.low[axis] = grid->low[axis] + voxel * std::round((-0.5 * inFaces.size - grid->low[axis]) / voxel);
  halfOff = {inFaces.low + 0.5 * voxel, inFaces.size};
  const Frame got = bench.render(roomInBounds(inFaces), shot),
              wanted = bench.render(roomInBounds(halfOff), shot);
  // The case about faces requires that the grid has not moved with the room.
  constexpr double kRounding = 1e-3;  // voxels
  const double distances[] = {offFaces(coarsestGrid(got).value(), inFaces, 0.0),
                              offFaces(coarsestGrid(wanted).value(), halfOff, 0.5)};
  if (distances[0] > kRounding || std::abs(distances[1] - 0.5) > kRounding)
    throw Error(fmt::format("the walls lie {:.3g} and {:.3g} voxels off the faces; expected 0 and 0.5",
                            distances[0], distances[1]));
  constexpr const char* kWhat = "the same half a voxel off";
  if (got.voxels && wanted.voxels) {
    const double missed = missedShare(*got.voxels, inFaces), usual = missedShare(*wanted.voxels, halfOff);
    return judged(
        fmt::format("share of the walls that no voxel of either side shows, beyond that of {}", kWhat),
        {std::max(missed - usual, 0.0), 0.0}, 0.05,
        fmt::format("missed: {:.3g}; {}: {:.3g}", missed, kWhat, usual));
  }
  bench.show(got.compared);
  std::string detail = fmt::format("{} voxels from wall to wall", count);
  if (makesIndirect(got)) {
    constexpr int kSamples = 64;  // of all pixels together a hundred thousand and more
    const double reference = meanOf(indirectLayer(bench, roomInBounds(halfOff), wanted, shot, kSamples).mean);
    detail += fmt::format(
        "; indirect light {:.3g} of the reference's, half a voxel off {:.3g}, RMS difference {:.3g}",
        meanOf(indirectOf(got)) / reference, meanOf(indirectOf(wanted)) / reference,
        relativeDifference(indirectOf(got), indirectOf(wanted)));
  }
  return judged(fmt::format("RMS difference from {}, of its mean", kWhat),
                {relativeDifference(got.compared, wanted.compared), 0.0}, 0.05, detail);
}

constexpr int kDeepest = 1024;

/// A tunnel along z whose grids have 1024 voxels from end to end.
std::optional<Finding> gridOf1024Deep(Bench& bench) {
  Shot shot;
  for (const PassParameter& one : allPassParameters(bench.pipeline(), bench.techniques()))
    if (one.words.empty() && one.high >= kDeepest && one.name.substr(one.name.find('.') + 1) == "resolution")
      shot.passParameters[one.name].number = kDeepest;
  if (shot.passParameters.empty())
    return notApplicable(fmt::format("no grid of it can be {} deep", kDeepest));
  const Scene scene = tunnel();
  if (!makesImages(bench)) {
    const auto error = bench.voxelError(scene, shot);
    if (!error) return std::nullopt;
    return judged("share of wrong voxels", {wrongShare(*error), 0.0}, 0.05);
  }
  const Frame frame = bench.render(scene, shot);
  if (frame.whole.empty()) return withoutLight();
  if (!makesIndirect(frame)) return againstReference(bench, scene, 0.1, shot);
  const double ratio = meanOf(indirectOf(frame)) / indirectReference(bench, scene, frame);
  return judged("distance of the indirect light's mean from the reference's, of it",
                {std::abs(ratio - 1.0), 0.0}, 0.25, fmt::format("{:.3g} of the reference's", ratio));
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
      {info("walls_in_faces",
            "a room whose walls lie in faces of voxels: the image of the same room half a voxel off", true),
       wallsInFaces},
      {info("grid_1024_deep",
            "a tunnel of 15 m in grids of 1024 voxels along z: the mean of the indirect light against the "
            "reference; voxels against the exact test",
            false),
       gridOf1024Deep},
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
