// The printed cone through a reflection grid made by hand (thesis Gomes 2015, Sec. 4.3.5), against its
// recurrence.
#include <algorithm>
#include <cmath>

#include "support/light_cells.h"

using namespace lumivox;
using namespace lumivox::test;

TEST_CASE(
    "the printed cone gathers from a solid grid what its recurrence gives, and fades the wrong way round") {
  // Listings 4.13 and 4.37 in a grid of opacity 1 everywhere and of radiance k + 1 in its mip level k: D
  // voxels wide, a cone sees log2 D + 1. The diameter D is that of the lobe's solid angle 2 pi / (n + 1), at
  // most that of half the half sphere, and two voxels at least: where the cone begins. The next sample lies
  // D / 2 further; the exponent is half of D over the first one. Each sample is multiplied by its fade f,
  // what was gathered by the opacity: L <- L A + (1 - A) a f (log2 D + 1) with a = 1 - (1 - f)^exponent, A <-
  // A + (1 - A) a. The whole falls to nothing at half a side of the grid from the eye.
  constexpr int voxels = 64;
  constexpr double half = 1.5, size = 2.0 * half / voxels;  // m
  const SceneBuilder builder = emptyScene();
  const SceneSnapshot snapshot = snapshotOf(builder.scene, 0.0);
  RadianceGrid grid;
  grid.grid = {snapshot.camera.eye - float(half), static_cast<float>(size), glm::ivec3(voxels)};
  const gpu::TextureDescription description =
      volumeOf(glm::ivec3(voxels), gpu::Format::rgba32f, gpu::fullLevelCount(voxels, voxels, voxels));
  grid.radiance = filled(description, glm::vec4(0.0f));
  for (int level = 0; level < description.levels; ++level)
    grid.radiance->clear(glm::vec4(glm::vec3(level + 1.0f), 1.0f), level);
  grid.unit = 3.0f;
  LonePass trace("light_propagation_volumes.trace", builder.scene);
  trace.in("grid", grid);
  struct Cone {
    float exponent;
    double reach, behind;  ///< m; from the eye to the surface
    float cosine = 1.0f;   ///< of the way from the surface to the eye and its normal
  };
  for (const Cone& cone :
       {Cone{1e6f, 1.2, 0.6}, Cone{20.0f, 1.2, 0.6}, Cone{5.0f, 1.05, 0.6}, Cone{1.0f, 0.6, 0.6},
        Cone{0.3f, 0.6, 0.6}, Cone{1e6f, 0.7, 0.15}, Cone{1e6f, 0.7, 1.6}, Cone{1e6f, 1.5 * size, 0.6},
        Cone{1e6f, 0.6, 0.6, 0.2f}, Cone{1e6f, 0.6, 0.6, -0.5f}})
    for (const char* fade : {"grows", "falls", "none"}) {
      if (cone.behind > half && std::string(fade) == "none") continue;  // the cone begins outside of the grid
      const glm::vec3 position = snapshot.camera.eye - float(cone.behind) * glm::vec3(0, 0, 1),
                      normal(0.0f, std::sqrt(1.0f - cone.cosine * cone.cosine), cone.cosine);
      const ImageBuffer glossy =
          trace.with({{"reach", cone.reach}, {"fade", fade}})
              .in("gbuffer",
                  gbufferAt({position, normal, glm::vec3(1.0f), {0.2f, 0.1f, 0.05f, cone.exponent}}))
              .image("glossy");
      const double cosine = std::max(1.0 - 1.0 / (cone.exponent + 1.0), 0.5);
      const double ratio = 2.0 * std::tan(std::acos(cosine));
      double gathered = 0.0, opacity = 0.0, distance = 2.0 * size;
      const double first = std::max(2.0 * size, ratio * distance);
      while (distance <= cone.reach && opacity < 1.0) {
        const double diameter = std::max(2.0 * size, ratio * distance);
        const double f = std::string(fade) == "grows"   ? distance / cone.reach
                         : std::string(fade) == "falls" ? 1.0 - distance / cone.reach
                                                        : 1.0;
        const double a = 1.0 - std::pow(1.0 - f, 0.5 * diameter / first);
        gathered = gathered * opacity + (1.0 - opacity) * a * f * (std::log2(diameter / size) + 1.0);
        opacity += (1.0 - opacity) * a;
        distance += 0.5 * diameter;
      }
      const double atSurface = std::string(fade) == "none" ? 1.0 : std::max(1.0 - cone.behind / half, 0.0);
      const double expected = 3.0 * gathered * atSurface * std::max(cone.cosine, 0.0f);
      INFO(fade << ", exponent " << cone.exponent << ", reach " << cone.reach << ", " << cone.behind
                << " from the eye, cosine " << cone.cosine);
      for (int channel = 0; channel < 3; ++channel)
        CHECK(glossy.at(4, 4, channel) == Approx(0.2 * std::exp2(-channel) * expected).epsilon(5e-3));
    }
}

TEST_CASE(
    "behind a wall that is seen through, each empty step of the printed cone leaves A of what it gathered") {
  // Listing 4.13 multiplies what was gathered by the opacity A in every step, also where nothing is: n empty
  // steps behind a wall leave A^n of its light. The printed fade keeps walls from closing, so that hardly
  // anything is left of reflections (Fig. 76 as printed).
  constexpr int voxels = 64;
  constexpr float size = 0.05f, opacity = 0.5f;   // m
  constexpr int seen = 24, first = 34, end = 38;  // voxels along z: of the surface, and of the wall
  const SceneBuilder builder = emptyScene();
  const SceneSnapshot snapshot = snapshotOf(builder.scene, 0.0);
  RadianceGrid grid;
  grid.grid = {snapshot.camera.eye - 0.5f * size * voxels, size, glm::ivec3(voxels)};
  grid.radiance = filled(volumeOf(glm::ivec3(voxels), gpu::Format::rgba32f, 2), glm::vec4(0.0f));
  for (int level = 0; level < 2; ++level) {
    const std::size_t side = voxels >> level, slice = side * side * 4;
    std::vector<float> values(side * slice, 0.0f);
    std::fill(values.begin() + (first >> level) * slice, values.begin() + (end >> level) * slice, opacity);
    grid.radiance->uploadFloats(level, values);
  }
  LonePass trace("light_propagation_volumes.trace", builder.scene);
  trace.in("grid", grid);
  const glm::vec3 position = snapshot.camera.eye - glm::vec3(0, 0, (0.5f * voxels - seen) * size);
  trace.in("gbuffer", gbufferAt({position, {0, 0, 1}, glm::vec3(1.0f), {1, 1, 1, 1e6f}}));
  const auto gathered = [&](int steps) {  // of a voxel each
    return trace.with({{"fade", "none"}, {"reach", (steps + 0.5) * size}}).image("glossy").at(4, 4, 0);
  };
  // Between the middles of two voxels of level 1, two finest ones wide, lies a line between their values;
  // each sample stands for half of its diameter.
  double through = 1.0;
  for (int step = 2; step < end - seen + 2; ++step) {
    const double place = (seen + step) / 2.0 - 0.5, share = place - std::floor(place);
    const auto inWall = [](double k) { return k >= first / 2 && k < end / 2 ? double{opacity} : 0.0; };
    through *=
        std::sqrt(1.0 - (1.0 - share) * inWall(std::floor(place)) - share * inWall(std::floor(place) + 1.0));
  }
  const double wall = 1.0 - through;
  CHECK(wall > 0.6);
  CHECK(wall < 0.9);
  const float behind = gathered(end - seen + 2);
  CHECK(behind > 0.05f);
  for (const int steps : {1, 2, 5, 10})
    CHECK(gathered(end - seen + 2 + steps) == Approx(behind * std::pow(wall, steps)).epsilon(1e-3));
}

TEST_CASE("the printed cone leaves pixels black where nothing is seen, or nothing glossy") {
  const SceneBuilder builder = emptyScene();
  const SceneSnapshot snapshot = snapshotOf(builder.scene, 0.0);
  RadianceGrid grid;
  grid.grid = {snapshot.camera.eye - 1.0f, 0.25f, glm::ivec3(8)};
  grid.radiance = volume(8, gpu::Format::rgba32f);
  grid.radiance->clear(glm::vec4(1.0f));
  LonePass trace("light_propagation_volumes.trace", builder.scene);
  trace.in("grid", grid);
  for (const bool isSeen : {true, false})
    for (const float albedo : {0.3f, 0.0f}) {
      const glm::vec3 position = snapshot.camera.eye - glm::vec3(0, 0, 0.3f);
      const float value =
          trace
              .in("gbuffer",
                  gbufferAt({position, {0, 0, 1}, glm::vec3(1.0f), {glm::vec3(albedo), 20.0f}, isSeen}))
              .image("glossy")
              .at(4, 4, 1);
      if (isSeen && albedo > 0.0f) CHECK(value > 0.01f);
      if (!isSeen || albedo == 0.0f) CHECK(value == 0.0f);
    }
}
