// How lights become point samples: every area light has some, and they carry its light.
#include "lumivox/toolkit/light_samples.h"

#include <cmath>

#include "support/scene_builder.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

/// Area lights of one square metre each in a row along x, two metres apart, facing down.
Scene rowOfAreaLights(const std::vector<float>& radiances) {
  SceneBuilder builder;
  for (std::size_t i = 0; i < radiances.size(); ++i)
    builder.quad({2.0f * static_cast<float>(i), 1, 0}, {1, 0, 0}, {0, 0, 1},
                 builder.lambert(0.0f, radiances[i]));
  return builder.scene;
}

struct AreaLightSamples {
  int count = 0;
  double power = 0.0;
};

AreaLightSamples samplesOf(const LightSet& set, const SceneSnapshot& snapshot, std::size_t areaLight) {
  AreaLightSamples result;
  for (const LightSampleData& sample : set.samples) {
    if (static_cast<std::size_t>((sample.position.x + snapshot.origin.x) / 2.0) != areaLight) continue;
    ++result.count;
    result.power += sample.power.x;
  }
  return result;
}

/// A mask whose columns of texels from `firstHole` on are holes.
SurfaceTexture columnMask(int width, int firstHole) {
  SurfaceTexture mask;
  mask.mask = true;
  mask.width = width, mask.height = 4;
  for (int i = 0; i < width * mask.height; ++i) mask.values.push_back(i % width < firstHole ? 1.0f : 0.0f);
  return mask;
}

/// An area light of one square metre at the height 1 that shines downwards, u along x.
Scene maskedAreaLight(const SurfaceTexture& mask, float radiance) {
  SceneBuilder builder;
  builder.scene.textures.push_back(mask);
  Material material;
  material.maskTexture = 0;
  material.emission = glm::vec3(radiance);
  builder.quad({0, 1, 0}, {1, 0, 0}, {0, 0, 1}, builder.material(material));
  return builder.scene;
}

}  // namespace

TEST_CASE("every area light has samples with its radiance times area, beside a far brighter one") {
  // The power of an area light's samples, W/sr along its normal, is the integral of its radiance over its
  // area.
  const std::vector<float> radiances{1.0f, 1e6f, 0.5f, 2e6f};
  const Scene scene = rowOfAreaLights(radiances);
  const SceneSnapshot snapshot = snapshotOf(scene, 0.0);
  for (const int count : {4, 5, 16, 64}) {
    const LightSet set = sampleLights(scene, snapshot, count, 64);
    INFO(count << " samples");
    REQUIRE(set.samples.size() == static_cast<std::size_t>(count));
    for (std::size_t areaLight = 0; areaLight < radiances.size(); ++areaLight) {
      const AreaLightSamples found = samplesOf(set, snapshot, areaLight);
      INFO("area light " << areaLight << " has " << found.count);
      CHECK(found.count >= 1);
      CHECK(found.power == Approx(radiances[areaLight]).epsilon(1e-5));
    }
    // Beyond one each they go by power.
    CHECK(std::abs(samplesOf(set, snapshot, 3).count - 1 - 2 * (samplesOf(set, snapshot, 1).count - 1)) <= 2);
  }
}

TEST_CASE("more area lights than samples still give all light together, the brightest first") {
  const Scene scene = rowOfAreaLights({1.0f, 8.0f, 1.0f});
  const SceneSnapshot snapshot = snapshotOf(scene, 0.0);
  const LightSet set = sampleLights(scene, snapshot, 2, 64);
  REQUIRE(set.samples.size() == 2);
  CHECK(samplesOf(set, snapshot, 1).count == 2);
  CHECK(samplesOf(set, snapshot, 1).power == Approx(10.0).epsilon(1e-5));
}

TEST_CASE("a scene without emission has no samples of area lights") {
  SceneBuilder builder;
  builder.quad({0, 0, 0}, {1, 0, 0}, {0, 0, 1}, builder.lambert(0.5f));
  CHECK(sampleLights(builder.scene, snapshotOf(builder.scene, 0.0), 16, 64).samples.empty());
}

TEST_CASE("an area light whose mask leaves a share of it gives that share of the light, from there") {
  // Columns 0 to k-1 of n are opaque. Bilinearly between texel centres the coverage passes a half in the
  // middle between two columns, and around the repeat at u = 0 and u = 1 too: the opaque share is k / n.
  for (const int opaque : {1, 4, 5, 7}) {
    constexpr int kColumns = 8;
    const Scene scene = maskedAreaLight(columnMask(kColumns, opaque), 3.0f);
    const SceneSnapshot snapshot = snapshotOf(scene, 0.0);
    const double share = double(opaque) / kColumns;
    for (const int count : {1, 7, 64}) {
      CAPTURE(opaque, count);
      const LightSet set = sampleLights(scene, snapshot, count, 64);
      REQUIRE(set.samples.size() == static_cast<std::size_t>(count));
      double power = 0.0;
      for (const LightSampleData& sample : set.samples) {
        power += sample.power.x;
        CHECK(sample.position.x + snapshot.origin.x <= share + 1e-4);
      }
      CHECK(power == Approx(3.0 * share).epsilon(0.01));
    }
  }
}

TEST_CASE("samples of a masked area light fill what is left of it evenly") {
  // The mean of x over the opaque part [0, 1/2] is 1/4, its variance (1/2)^2 / 12; z knows nothing of the
  // mask.
  const Scene scene = maskedAreaLight(columnMask(8, 4), 1.0f);
  const SceneSnapshot snapshot = snapshotOf(scene, 0.0);
  const LightSet set = sampleLights(scene, snapshot, 1024, 64);
  double x = 0.0, squares = 0.0, z = 0.0;
  for (const LightSampleData& sample : set.samples) {
    const double place = sample.position.x + snapshot.origin.x;
    x += place / 1024.0;
    squares += place * place / 1024.0;
    z += (sample.position.z + snapshot.origin.z) / 1024.0;
  }
  CHECK(x == Approx(0.25).epsilon(0.02));
  CHECK(squares - x * x == Approx(0.25 / 12.0).epsilon(0.04));
  CHECK(z == Approx(0.5).epsilon(0.02));
}

TEST_CASE("an area light that is all hole has no samples, beside one that is whole") {
  Scene scene = maskedAreaLight(columnMask(8, 0), 5.0f);
  CHECK(sampleLights(scene, snapshotOf(scene, 0.0), 16, 64).samples.empty());
  scene.textures[0] = columnMask(8, 8);
  const LightSet set = sampleLights(scene, snapshotOf(scene, 0.0), 16, 64);
  double power = 0.0;
  for (const LightSampleData& sample : set.samples) power += sample.power.x;
  CHECK(set.samples.size() == 16);
  CHECK(power == Approx(5.0).epsilon(1e-5));
}

TEST_CASE("ten thousand masked leaves that shine carry the light of their opaque halves") {
  SceneBuilder builder;
  builder.scene.textures.push_back(columnMask(512, 256));
  Material material;
  material.maskTexture = 0;
  material.emission = glm::vec3(1.0f);
  const int leaf = builder.material(material);
  for (int i = 0; i < 5000; ++i)
    builder.quad({0.1f * static_cast<float>(i), 1, 0}, {0.1f, 0, 0}, {0, 0, 0.1f}, leaf);
  double power = 0.0;
  for (const LightSampleData& sample :
       sampleLights(builder.scene, snapshotOf(builder.scene, 0.0), 64, 64).samples)
    power += sample.power.x;
  CHECK(power == Approx(0.5 * 5000 * 0.01).epsilon(0.02));
}

TEST_CASE("each light is a disc as a whole: a square lamp one of its own spread, at its middle") {
  // Over a square of side s points lie s^2 / 6 from the middle in the mean of the squares, over a disc r^2
  // / 2.
  SceneBuilder builder;
  builder.light(LightKind::point, glm::vec3(1.0f), {3, 4, 5});
  builder.quad({1, 2, 0}, {0.6f, 0, 0}, {0, 0, 0.6f}, builder.lambert(0.0f, 4.0f));
  builder.box({-1, 0, -1}, {-0.5f, 0.5f, -0.5f}, builder.lambert(0.0f, 1.0f), false);
  const SceneSnapshot snapshot = snapshotOf(builder.scene, 0.0);
  const LightSet set = sampleLights(builder.scene, snapshot, 16, 64);
  const glm::vec3 origin(snapshot.origin);
  REQUIRE(set.discs.size() == 1 + 1 + 6);
  CHECK(glm::length(set.discs[0].centre + origin - glm::vec3(3, 4, 5)) < 1e-5f);
  CHECK(set.discs[0].radius == 0.0f);
  const LightDisc& square = set.discs[1];
  CHECK(glm::length(square.centre + origin - glm::vec3(1.3f, 2, 0.3f)) < 1e-5f);
  CHECK(square.radius == Approx(0.6 / std::sqrt(3.0)));
  CHECK(glm::length(square.normal - glm::vec3(0, -1, 0)) < 1e-5f);
  // Every sample belongs to one disc.
  int next = 0;
  for (const LightDisc& disc : set.discs) {
    CHECK(disc.firstSample == next);
    CHECK(disc.sampleCount >= 1);
    next += disc.sampleCount;
  }
  CHECK(next == static_cast<int>(set.samples.size()));
}

TEST_CASE("the normal of a curved light's disc is short, and more lights than samples are a disc a sample") {
  SceneBuilder builder;
  const int lamp = builder.lambert(0.0f, 1.0f);
  // Two sides of a roof at right angles: the mean of their normals is cos 45 degrees long.
  Object& roof = builder.mesh({{0, 1, 0}, {1, 0, 0}, {0, 1, 1}, {0, 1, 0}, {0, 1, 1}, {-1, 0, 0}}, lamp);
  REQUIRE(roof.parts.size() == 1);
  const LightSet curved = sampleLights(builder.scene, snapshotOf(builder.scene, 0.0), 16, 64);
  REQUIRE(curved.discs.size() == 1);
  CHECK(glm::length(curved.discs[0].normal) == Approx(std::sqrt(0.5)));

  const Scene many = rowOfAreaLights({1, 2, 3, 4, 5});
  const LightSet few = sampleLights(many, snapshotOf(many, 0.0), 3, 64);
  REQUIRE(few.discs.size() == 3);
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(few.discs[i].centre == few.samples[i].position);
    CHECK(few.discs[i].radius == Approx(std::sqrt(few.samples[i].patchRadiusSquared)));
  }
}
