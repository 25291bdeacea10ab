// Participating media and cone tracing: media that dim what is injected, and media in the voxels of the grid.
#include <algorithm>
#include <cmath>

#include "support/cones.h"
#include "support/marching.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::cones;

namespace {

/// The same medium as voxels of 1/16 m, each of density 1, in multiples of which the box must be.
ScatteringGrid asVoxels(const ScatteringGrid& even) {
  constexpr float kSize = 1.0f / 16.0f;
  const ScatteringGrid::Medium& medium = even.media.front();
  const glm::ivec3 size((medium.bounds.high - medium.bounds.low) / kSize + 0.5f);
  ScatteringGrid result =
      varyingMedium(0.0f, 0.0f, 0.0f, medium.bounds.low, kSize, size, [](const glm::vec3&) { return 1.0f; });
  result.media.front().extinction = medium.extinction;
  result.media.front().albedo = medium.albedo;
  return result;
}

/// A floor under a vertical sun of 3 W/m^2, in a grid of height 2.
Scene sunlitFloor(float albedo) {
  SceneBuilder builder;
  builder.quad({-1, -1, -1}, {0, 0, 2}, {2, 0, 0}, builder.lambert(albedo));
  builder.quad({-1, 1, -1}, {0, 0, 0.01f}, {0.01f, 0, 0},
               builder.lambert(0.0f));  // gives the grid its height
  builder.light(LightKind::directional, glm::vec3(3.0f), {}, {0, -1, 0});
  builder.look({0.02, -0.9, 0.02}, {0.02, 1, 0.02}, {0, 0, 1}, 0.7, cones::kPixels,
               cones::kPixels);  // from below
  return builder.scene;
}

glm::vec4 voxelAt(const RadianceGrid& grid, const std::vector<float>& texels, const glm::vec3& place) {
  const glm::ivec3 cell((place - grid.grid.low) / grid.grid.voxelSize);
  const std::size_t i = 4 * static_cast<std::size_t>(
                                (cell.z * grid.grid.resolution.y + cell.y) * grid.grid.resolution.x + cell.x);
  return {texels[i], texels[i + 1], texels[i + 2], texels[i + 3]};
}

/// Radiance that a mirror of albedo 1 under the ceiling sees straight below.
glm::vec3 seenStraightBelow(const Scene& scene, const RadianceGrid& grid) {
  GatherSettings settings;
  settings.start = 1.0;
  return gatherGlossy(scene, grid, {0.02f, 0.8f, 0.02f}, {0, -1, 0}, glm::vec4(1, 1, 1, 1e6f), settings);
}

}  // namespace

TEST_CASE(
    "media between a light and a surface dim what is injected by exp(-extinction x length) per channel") {
  // The sun comes down through half a metre of it: albedo / pi E exp(-sigma_t / 2).
  const glm::vec3 extinction(1.0f, 2.0f, 4.0f);
  const Scene scene = sunlitFloor(0.6f);
  const ScatteringGrid even = evenMedium(extinction, glm::vec3(0.5f), 0.0f, {-2, -0.5f, -2}, {2, 0, 2});
  for (const ScatteringGrid& medium : {even, asVoxels(even)}) {
    InjectSettings settings;
    settings.media = &medium;
    const RadianceGrid grid = injectedGrid(scene, 32, settings);
    const glm::vec4 floor = voxelAt(grid, grid.radiance->downloadFloats(0), {0.3f, -0.99f, 0.3f});
    REQUIRE(floor.a == 1.0f);
    for (int c = 0; c < 3; ++c)
      CHECK(floor[c] == Approx(0.6 / kPi * 3.0 * std::exp(-0.5 * extinction[c])).epsilon(0.003));
    CHECK_FALSE(grid.holdsMedia);
  }
}

TEST_CASE("smoke in the voxels dims a lit floor by exp(-extinction x length), as media beside the grid do") {
  // Black smoke over the floor: the sun is dimmed in any case, and what the mirror sees once more by the
  // smoke in the grid. Voxels are 1/32 m: a voxel's opacity is 1 - exp(-sigma_t / 32), and the product over
  // the half metre exp(-sigma_t / 2); at the borders, trilinear opacities in place of depths are off by a
  // part of one voxel's depth.
  const Scene scene = sunlitFloor(0.6f);
  for (const float extinction : {0.5f, 2.0f, 6.0f}) {
    const ScatteringGrid even =
        evenMedium(glm::vec3(extinction), glm::vec3(0.0f), 0.0f, {-2, -0.5f, -2}, {2, 0, 2});
    for (const ScatteringGrid& medium : {even, asVoxels(even)}) {
      InjectSettings settings;
      settings.media = &medium;
      const glm::vec3 clear = seenStraightBelow(scene, filtered(injectedGrid(scene, 64, settings)));
      settings.storeMedia = true;
      const RadianceGrid stored = injectedGrid(scene, 64, settings);
      CHECK(stored.holdsMedia);
      const glm::vec3 dimmed = seenStraightBelow(scene, filtered(stored));
      INFO("extinction " << extinction << ", " << (medium.media.front().density ? "voxels" : "even"));
      REQUIRE(clear.r > 0.01f);
      CHECK(dimmed.r / clear.r == Approx(std::exp(-0.5 * extinction)).epsilon(0.01));
    }
  }
}

TEST_CASE(
    "smoke in a voxel has the opacity 1 - exp(-extinction x width) and scatters the light that reaches it evenly") {
  // At the depth z the sun has E exp(-sigma_t z) left. A voxel scatters albedo E / (4 pi) of it to every
  // side, as far as it is opaque; opacity is that of the mean of the channels.
  const glm::vec3 extinction(1.0f, 2.0f, 3.0f), albedo(0.9f, 0.5f, 0.25f);
  const Scene scene = sunlitFloor(0.6f);
  const ScatteringGrid medium = evenMedium(extinction, albedo, 0.0f, {-2, -0.5f, -2}, {2, 0, 2});
  InjectSettings settings;
  settings.media = &medium;
  for (const char* precision : {"float", "half"}) {
    settings.precision = precision;
    settings.storeMedia = false;
    const RadianceGrid surfaces = injectedGrid(scene, 64, settings);
    settings.storeMedia = true;
    const RadianceGrid grid = injectedGrid(scene, 64, settings);
    const std::vector<float> texels = grid.radiance->downloadFloats(0);
    const float width = grid.grid.voxelSize;
    const double tolerance = std::string(precision) == "half" ? 0.01 : 0.001;
    int voxels = 0;
    for (float y = -0.5f + 0.5f * width; y < 0.0f; y += width, ++voxels) {
      const glm::vec4 value = voxelAt(grid, texels, {0.3f, y, 0.3f});
      // The middle of the voxel that this place is in.
      const float cell = std::floor((y - grid.grid.low.y) / width);
      const double middle = grid.grid.low.y + (cell + 0.5) * width;
      if (middle - 0.5 * width < -0.5 || middle + 0.5 * width > 0.0) continue;  // partly outside
      INFO(precision << ", height " << y);
      CHECK(value.a == Approx(1.0 - std::exp(-2.0 * width)).epsilon(tolerance));
      for (int c = 0; c < 3; ++c) {
        const double scattered = albedo[c] * 3.0 * std::exp(extinction[c] * middle) / (4.0 * kPi);
        CHECK(value[c] * grid.unit ==
              Approx(scattered * (1.0 - std::exp(-extinction[c] * width))).epsilon(tolerance));
      }
    }
    CHECK(voxels > 10);
    // Surfaces are what they were, and above the smoke there is nothing.
    CHECK(voxelAt(grid, texels, {0.3f, -0.99f, 0.3f}) ==
          voxelAt(surfaces, surfaces.radiance->downloadFloats(0), {0.3f, -0.99f, 0.3f}));
    CHECK(voxelAt(grid, texels, {0.3f, 0.5f, 0.3f}) == glm::vec4(0.0f));
  }
}

TEST_CASE(
    "without light the smoke in the voxels is dark and as opaque, and in a shadow it scatters nothing") {
  Scene scene = sunlitFloor(0.6f);
  const ScatteringGrid medium =
      evenMedium(glm::vec3(2.0f), glm::vec3(0.9f), 0.0f, {-2, -0.5f, -2}, {2, 0, 2});
  InjectSettings settings;
  settings.media = &medium;
  settings.storeMedia = true;
  settings.lights = false;
  const RadianceGrid dark = injectedGrid(scene, 32, settings);
  const glm::vec4 value = voxelAt(dark, dark.radiance->downloadFloats(0), {0.3f, -0.25f, 0.3f});
  CHECK(glm::vec3(value) == glm::vec3(0.0f));
  CHECK(value.a == Approx(1.0 - std::exp(-2.0 * dark.grid.voxelSize)).epsilon(0.001));

  SceneBuilder builder;
  builder.scene = scene;
  builder.quad({-1, 0.5f, -1}, {0, 0, 2}, {1, 0, 0}, builder.lambert(0.0f));  // a roof over one half
  settings.lights = true;
  const RadianceGrid grid = injectedGrid(builder.scene, 32, settings);
  const std::vector<float> texels = grid.radiance->downloadFloats(0);
  CHECK(voxelAt(grid, texels, {-0.5f, -0.25f, 0.3f}).r == 0.0f);
  CHECK(voxelAt(grid, texels, {0.5f, -0.25f, 0.3f}).r > 0.0f);
}
