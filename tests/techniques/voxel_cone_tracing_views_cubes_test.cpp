// Looking at the voxels of a list as cubes, against every cube met by every line of sight.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "lumivox/pipeline/pass.h"
#include "support/made_fragments.h"
#include "support/scene_builder.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

constexpr double kNoVoxel = 0.02;
constexpr double kBrightness[3] = {0.8, 1.0, 0.65};  ///< of sides across x, y and z

struct Hit {
  double at = std::numeric_limits<double>::infinity();  ///< voxels from the eye
  int side = 0;
  bool nearlyAnother = false;  ///< the line nearly meets an edge of the cube
};

/// Where a line of sight enters the cube [low, low + 1].
std::optional<Hit> entry(const glm::dvec3& eye, const glm::dvec3& direction, const glm::dvec3& low) {
  Hit hit;
  hit.at = -1.0;
  double leave = std::numeric_limits<double>::infinity(), second = -1.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double a = (low[axis] - eye[axis]) / direction[axis],
                 b = (low[axis] + 1.0 - eye[axis]) / direction[axis];
    if (std::min(a, b) > hit.at) {
      second = hit.at;
      hit.at = std::min(a, b);
      hit.side = axis;
    } else {
      second = std::max(second, std::min(a, b));
    }
    leave = std::min(leave, std::max(a, b));
  }
  if (leave < hit.at - 1e-3) return std::nullopt;
  hit.nearlyAnother = std::abs(leave - hit.at) < 1e-3 || hit.at - second < 1e-3;
  return hit;
}

ImageBuffer cubes(const Scene& scene, const SceneSnapshot& snapshot, const VoxelFragments& list,
                  double cut = 0.0) {
  PassHarness look(device(), techniques(), "voxel_cone_tracing", "look", scene, snapshot);
  look.setParameter("faces", "edges");
  look.setParameter("background", kNoVoxel);
  look.setParameter("cut", cut);
  look.setInput("voxels", list);
  look.run();
  return imageOf(*look.output<Image>("radiance").texture);
}

}  // namespace

TEST_CASE("every line of sight shows the nearest cube, with darker edges where cubes are wide enough") {
  // Single voxels with gaps between them, seen from a corner: lines of sight cross many empty voxels, towards
  // higher and lower ones along every axis.
  constexpr int kVoxels = 12;
  std::vector<glm::ivec3> voxels;
  std::vector<FragmentData> fragments;
  for (int i = 0; i < kVoxels; ++i)
    for (int j = 0; j < kVoxels; ++j) {
      const glm::ivec3 voxel(i, j, (5 * i + 7 * j) % kVoxels);
      voxels.push_back(voxel);
      fragments.push_back(squareAt((glm::dvec3(voxel) + 0.5) / 2.0, {0, 0, 1}));
    }
  const GridPlacement cells{glm::vec3(-1.2f), 0.4f, glm::ivec3(kVoxels / 2)};
  for (const glm::vec3& eye :
       {glm::vec3(1.9f, 2.1f, 2.4f), glm::vec3(-1.8f, 1.6f, -2.3f), glm::vec3(2.6f, -9.0f, 3.1f)}) {
    CAPTURE(eye.x, eye.y, eye.z);
    SceneBuilder builder;
    builder.look(eye, {0.05f, -0.1f, 0.02f}, {0, 1, 0}, 0.9, 96, 96);
    const SceneSnapshot snapshot = snapshotOf(builder.scene, 0.0);
    const ImageBuffer image = cubes(builder.scene, snapshot, listOver(cells, fragments));
    const CameraView& camera = snapshot.camera;
    const glm::dvec3 eyeGrid = (glm::dvec3(camera.eye) - glm::dvec3(cells.low)) / 0.2;
    const double pixelWidth = 2.0 * camera.tanHalfFov / camera.height;
    int looked = 0, lines = 0, empty = 0;
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) {
        const glm::dvec3 direction =
            glm::normalize(glm::dvec3(camera.forward) +
                           pixelWidth * ((x + 0.5 - 0.5 * camera.width) * glm::dvec3(camera.right) -
                                         (y + 0.5 - 0.5 * camera.height) * glm::dvec3(camera.up)));
        Hit nearest;
        bool clear = true;  // no line nearly along an edge: there rounding decides
        for (const glm::ivec3& voxel : voxels)
          if (const std::optional<Hit> hit = entry(eyeGrid, direction, glm::dvec3(voxel))) {
            clear = clear && !hit->nearlyAnother;
            if (hit->at < nearest.at) nearest = *hit;
          }
        double expected = kNoVoxel;
        if (std::isfinite(nearest.at)) {
          const double pixel = nearest.at * pixelWidth, wide = std::max(0.03, 0.6 * pixel);
          double toEdge = 0.5;
          const glm::dvec3 place = eyeGrid + nearest.at * direction;
          for (int axis = 0; axis < 3; ++axis)
            if (axis != nearest.side)
              toEdge = std::min(
                  {toEdge, place[axis] - std::floor(place[axis]), std::ceil(place[axis]) - place[axis]});
          clear = clear && std::abs(toEdge - wide) > 1e-3;
          const double line = toEdge < wide ? std::clamp(1.0 - 4.0 * pixel, 0.0, 1.0) : 0.0;
          expected = kBrightness[nearest.side] * (1.0 - 0.65 * line);
          lines += line > 0.0;
        }
        if (!clear) continue;
        ++looked;
        empty += expected == kNoVoxel;
        REQUIRE(image.at(x, y, 1) == Approx(expected).margin(2e-3));
      }
    CHECK(looked > 96 * 96 * 9 / 10);
    // From afar pixels are wider than lines would be.
    CHECK((lines > 100) == (glm::length(eye) < 5.0f));
    CHECK(empty > 100);
  }
}

TEST_CASE("what is nearer than the cut is not seen, and lays open what is cut") {
  // A plate two voxels thick across the view axis, and a wall behind it on the left.
  const GridPlacement cells{glm::vec3(-1.0f), 0.5f, glm::ivec3(4)};
  std::vector<FragmentData> fragments;
  const auto add = [&](int x, int y, int z) {
    fragments.push_back(squareAt((glm::dvec3(x, y, z) + 0.5) / 2.0, {0, 0, 1}));
  };
  for (int x = 0; x < 8; ++x)
    for (int y = 0; y < 8; ++y) {
      add(x, y, 5), add(x, y, 6);
      if (x < 4) add(x, y, 0);
    }
  SceneBuilder builder;
  builder.look({0, 0, 11}, {0, 0, 0}, {0, 1, 0}, 0.1, 32, 32);
  const SceneSnapshot snapshot = snapshotOf(builder.scene, 0.0);
  const VoxelFragments list = listOver(cells, fragments);
  // The plate is at z 0.25..0.75, 10.25 to 10.75 m before the camera, and the wall's face at z -0.75.
  const auto grey = [&](double cut, int x) { return cubes(builder.scene, snapshot, list, cut).at(x, 13, 1); };
  for (const int x : {5, 26}) {
    CHECK(grey(0.0, x) == Approx(kBrightness[2]));
    CHECK(grey(10.2, x) == Approx(kBrightness[2]));
    CHECK(grey(10.3, x) == Approx(0.5));  // within
    CHECK(grey(10.7, x) == Approx(0.5));
    CHECK(grey(10.8, x) == Approx(x < 16 ? kBrightness[2] : kNoVoxel));
  }
}
