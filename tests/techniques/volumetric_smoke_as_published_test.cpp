// Listings 4.50 to 4.53 of thesis Gomes 2015 as they are printed.
#include <algorithm>
#include <cmath>

#include "support/filtered.h"
#include "support/marching.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

constexpr double kIsotropic = 1.0 / (4.0 * kPi);  // Listing 4.53 with g = 0, whatever the angle

Marched marchAsPublished(const Scene& scene, const ScatteringGrid& media, const GBuffer& gbuffer, int steps,
                         const Settings& words = {}) {
  Settings settings = words;
  settings.emplace_back("steps", steps);
  return marchBy("march_as_published", scene, media, gbuffer, settings);
}

/// A floor far below gives the scene its size, six metres, and a speck far above its middle, the origin;
/// neither casts a shadow on what is seen. The sun comes from ahead and above.
SceneBuilder sunnyFloor(float irradiance) {
  SceneBuilder builder;
  builder.quad({-2, -3, -2}, {0, 0, 4}, {4, 0, 0}, builder.lambert(0.5f));
  builder.quad({-2, 3, -2}, {0, 0, 0.01}, {0.01, 0, 0}, builder.lambert(0.5f));
  builder.look({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 0.7, kPixels, kPixels);
  builder.light(LightKind::directional, glm::vec3(irradiance), {}, {0, -0.6, 0.8});
  return builder;
}

double listing453(double cosine, double g, bool normalised = false) {
  const double base = 1.0 + g * g - 2.0 * g * cosine;
  return (1.0 - g) * (normalised ? 1.0 + g : 1.0 - g) / (4.0 * kPi * std::pow(base, 1.5));
}

/// As printed; the slip is the second entry of the second row.
double listing451(int row, int column) {
  static constexpr double kPattern[4][4] = {{0.0, 0.5, 0.125, 0.625},
                                            {0.75, 0.22, 0.875, 0.375},
                                            {0.1875, 0.6875, 0.0625, 0.5625},
                                            {0.9375, 0.4375, 0.8125, 0.3125}};
  return kPattern[row][column];
}

}  // namespace

TEST_CASE(
    "as published each pixel starts at its entry of the dither matrix: the column chooses the row, counted from the lower left") {
  // One step along a ray of a metre is looked at where the entry says. A medium that begins just before that
  // place scatters, one that begins just behind it does not.
  const Scene scene = sunnyFloor(3.0f).scene;
  const GBuffer gbuffer = surfacesAt([](int) { return glm::vec3(0, 0, -1); });
  for (const bool slip : {true, false})
    for (int row = 0; row < 4; ++row)
      for (int column = 0; column < 4; ++column)
        for (const double side : {-0.005, 0.005}) {
          const bool isSlip = row == 1 && column == 1;
          const double entry = isSlip && !slip ? 0.25 : listing451(row, column);
          const ScatteringGrid fog = evenMedium(glm::vec3(1.0f), glm::vec3(1.0f), 0.0f, {-5, -5, -5},
                                                {5, 5, static_cast<float>(-(entry + side))});
          const ImageBuffer found =
              marchAsPublished(scene, fog, gbuffer, 1,
                               {{"dither", slip ? "as_published" : "bayer"}, {"cosine", "unit_vectors"}})
                  .scattered;
          CAPTURE(row, column, side, slip);
          // Row 0 of an image is its top.
          CHECK(found.at(8 + row, kPixels - 1 - (12 + column), 0) ==
                Approx(side < 0.0 ? 3.0 * kIsotropic : 0.0).epsilon(1e-4).margin(1e-7));
        }
}

TEST_CASE(
    "as published media scatter by the share of the steps inside, whatever their extinction, and dim nothing") {
  // Steps of 1/8 m along 4 m; a metre of them inside is 8 of 32, for every entry of the dither matrix.
  const Scene scene = sunnyFloor(2.0f).scene;
  const GBuffer gbuffer = surfacesAt([](int) { return glm::vec3(0, 0, -4); });
  for (const float extinction : {1e-3f, 1e3f}) {
    const ScatteringGrid fog =
        evenMedium(glm::vec3(extinction), glm::vec3(0.3f), 0.7f, {-5, -5, -2.01f}, {5, 5, -1.01f});
    const Marched found = marchAsPublished(scene, fog, gbuffer, 32, {{"cosine", "unit_vectors"}});
    for (int i = 0; i < kPixels * kPixels; i += 117) {
      CHECK(valueOf(found.scattered, i) == Approx(0.25 * 2.0 * kIsotropic).epsilon(1e-4));
      CHECK(valueOf(found.transmittance, i) == 1.0f);
    }
  }
}

TEST_CASE("as published nothing is scattered where the shadow map has shadow") {
  // A roof over the left half; the sun has no part to the side. Every other pixel looks to the left.
  SceneBuilder builder = sunnyFloor(2.0f);
  builder.quad({-2, 1, -2}, {0, 0, 4}, {2, 0, 0}, builder.lambert(0.5f));
  const GBuffer gbuffer = surfacesAt([](int i) { return glm::vec3(i % 2 == 0 ? -1.0f : 1.0f, 0.0f, -0.5f); });
  const ScatteringGrid fog = evenMedium(glm::vec3(1.0f), glm::vec3(1.0f), 0.0f, {-5, -5, -5}, {5, 5, 5});
  const ImageBuffer found =
      marchAsPublished(builder.scene, fog, gbuffer, 32, {{"cosine", "unit_vectors"}}).scattered;
  // Beside the eye, at the roof's edge, a texel of the shadow map is half in the light.
  for (int i = 100; i < 200; ++i)
    CHECK(valueOf(found, i) == Approx(i % 2 == 0 ? 0.0 : 2.0 * kIsotropic).margin(0.1 * 2.0 * kIsotropic));
}

TEST_CASE(
    "as published the density sets g and the cosine is of the whole ray and the light's position, each mended alone") {
  // Half a particle everywhere: g = 1/2. The ray goes ahead, the sun is at a cosine of 0.8 with it.
  for (const double length : {0.5, 1.0, 3.0, 5.0}) {
    SceneBuilder builder = sunnyFloor(2.0f);
    const GBuffer gbuffer = surfacesAt([&](int) { return glm::vec3(0, 0, -length); });
    const ScatteringGrid half = varyingMedium(1.0f, 1.0f, 0.0f, glm::vec3(-6), 0.75f, glm::ivec3(16),
                                              [](const glm::vec3&) { return 0.5f; });
    const Bounds bounds = snapshotOf(builder.scene, 0.0).gridBounds;
    REQUIRE(bounds.low + bounds.high == glm::vec3(0.0f));
    const double unit = bounds.high.y;
    const auto found = [&](const char* cosine, const char* phase) {
      return double(valueOf(
          marchAsPublished(builder.scene, half, gbuffer, 4, {{"cosine", cosine}, {"phase", phase}}).scattered,
          77));
    };
    CAPTURE(length, unit);
    CHECK(found("unit_vectors", "as_published") == Approx(2.0 * listing453(0.8, 0.5)).epsilon(1e-3));
    CHECK(found("unit_vectors", "normalised") == Approx(2.0 * listing453(0.8, 0.5, true)).epsilon(1e-3));
    const double printed = 0.8 * length / unit;
    // A power of what is negative has no value.
    const double expected = 1.25 - printed > 0.0 ? 2.0 * listing453(printed, 0.5) : 0.0;
    CHECK(found("as_published", "as_published") == Approx(expected).epsilon(1e-3).margin(1e-7));
    // A light has a position; its light arrives as the inverse square, here at four places of the ray.
    builder.scene.lights.clear();
    const glm::dvec3 light(0.3, 1.2, -1.5);
    builder.light(LightKind::point, glm::vec3(10.0f), light);
    const double cosine = glm::dot(glm::dvec3(0, 0, -length) / unit, light / unit);
    const int row = 77 % kPixels % 4, column = (kPixels - 1 - 77 / kPixels) % 4;
    double irradiance = 0.0;
    for (int s = 0; s < 4; ++s) {
      const glm::dvec3 path = light - glm::dvec3(0, 0, -length * (s + listing451(row, column)) / 4.0);
      irradiance += 10.0 / glm::dot(path, path) / 4.0;
    }
    CHECK(found("as_published", "as_published") ==
          Approx(irradiance * listing453(cosine, 0.5)).epsilon(1e-3));
  }
}

TEST_CASE(
    "as published each particle counts one in its voxel, and a voxel of any number scatters as one of one") {
  const Medium medium = smokeFrom({0.1, -0.6, -2.0});
  SceneBuilder builder = sunnyFloor(2.0f);
  builder.scene.media.push_back(medium);
  const SceneSnapshot snapshot = snapshotOf(builder.scene, 0.0);
  LonePass particles("volumetric_smoke.particles", builder.scene),
      insert("volumetric_smoke.insert", builder.scene, {{"resolution", 24}, {"deposit", "counts"}});
  insert.in("particles", particles.out<Particles>("particles"));
  const ScatteringGrid grid = insert.out<ScatteringGrid>("media");
  const ScatteringGrid::Medium& inserted = grid.media.front();
  const glm::ivec3 size = inserted.grid.resolution;
  std::vector<int> counts(static_cast<std::size_t>(size.x * size.y * size.z), 0);
  const auto indexOf = [&](const glm::ivec3& voxel) {
    return static_cast<std::size_t>((voxel.z * size.y + voxel.y) * size.x + voxel.x);
  };
  const ParticleClock clock = particleClock(medium, 0.0);
  const glm::vec3 source(medium.source - snapshot.origin);
  for (std::uint32_t i = 0; i < 3000; ++i) {
    const glm::vec3 place = source + glm::vec3(particleAt(medium, clock, i)) - inserted.grid.low;
    ++counts[indexOf(glm::ivec3(glm::floor(place / inserted.grid.voxelSize)))];
  }
  const std::vector<float> density = inserted.density->downloadFloats(0);
  const double perParticle = particleMass(medium) / std::pow(double(inserted.grid.voxelSize), 3.0);
  int most = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    CHECK(density[i] == Approx(counts[i] * perParticle).epsilon(1e-5));
    most = std::max(most, counts[i]);
  }
  CHECK(most > 4);

  // The march finds counts between voxels by trilinear interpolation.
  const auto endOf = [](int i) {
    return glm::dvec3(1.6 * (i % kPixels + 0.5) / kPixels - 0.7, 0.9 - 1.6 * (i / kPixels + 0.5) / kPixels,
                      -3.0);
  };
  const GBuffer gbuffer = surfacesAt([&](int i) { return glm::vec3(endOf(i)); });
  constexpr int kSteps = 24;
  const ImageBuffer found =
      marchAsPublished(builder.scene, grid, gbuffer, kSteps, {{"cosine", "unit_vectors"}}).scattered;
  double lit = 0.0;
  for (int i = 31; i < kPixels * kPixels; i += 61) {
    const glm::dvec3 end = endOf(i), direction = glm::normalize(end);
    const double cosine = glm::dot(direction, glm::dvec3(0, 0.6, -0.8));
    double sum = 0.0;
    for (int s = 0; s < kSteps; ++s) {
      const double share = (s + listing451(i % kPixels % 4, (kPixels - 1 - i / kPixels) % 4)) / kSteps;
      const glm::dvec3 place =
          (end * share - glm::dvec3(inserted.grid.low)) / double(inserted.grid.voxelSize) - 0.5;
      const glm::dvec3 whole = glm::floor(place), part = place - whole;
      double amount = 0.0;
      for (int corner = 0; corner < 8; ++corner) {
        const glm::ivec3 step(corner & 1, corner >> 1 & 1, corner >> 2), voxel = glm::ivec3(whole) + step;
        if (glm::any(glm::lessThan(voxel, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(voxel, size)))
          continue;
        const glm::dvec3 weight = glm::mix(1.0 - part, part, glm::dvec3(step));
        amount += weight.x * weight.y * weight.z * counts[indexOf(voxel)];
      }
      sum += 2.0 * listing453(cosine, 1.0 - std::min(amount, 1.0)) / kSteps;
    }
    CAPTURE(i, sum);
    CHECK(valueOf(found, i) ==
          Approx(sum).epsilon(filtered(0.01f)).margin(device().info().software ? 1e-5 : 1e-4));
    lit += sum;
  }
  CHECK(lit > 0.1);
}
