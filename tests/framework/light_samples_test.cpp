// How lights become point samples: every lamp has some, and they carry its light.
#include "lumivox/pipeline/light_samples.h"

#include <cmath>

#include "support/scene_builder.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

/// Lamps of one square metre each in a row along x, two metres apart, facing down.
Scene rowOfLamps(const std::vector<float>& radiances) {
  SceneBuilder builder;
  for (std::size_t i = 0; i < radiances.size(); ++i)
    builder.quad({2.0f * static_cast<float>(i), 1, 0}, {1, 0, 0}, {0, 0, 1},
                 builder.lambert(0.0f, radiances[i]));
  return builder.scene;
}

struct LampSamples {
  int count = 0;
  double power = 0.0;
};

LampSamples samplesOf(const LightSet& set, const SceneSnapshot& snapshot, std::size_t lamp) {
  LampSamples result;
  for (const LightSampleData& sample : set.samples) {
    if (static_cast<std::size_t>((sample.positionKind.x + snapshot.origin.x) / 2.0) != lamp) continue;
    ++result.count;
    result.power += sample.power.x;
  }
  return result;
}

}  // namespace

TEST_CASE("every lamp has samples, which carry radiance times area of it, beside one 10^6 times as bright") {
  // The power of a lamp's samples, W/sr along its normal, is the integral of its radiance over its area.
  const std::vector<float> radiances{1.0f, 1e6f, 0.5f, 2e6f};
  const Scene scene = rowOfLamps(radiances);
  const SceneSnapshot snapshot = snapshotOf(scene, 0.0);
  for (const int count : {4, 5, 16, 64}) {
    const LightSet set = sampleLights(scene, snapshot, count, 64);
    INFO(count << " samples");
    REQUIRE(set.samples.size() == static_cast<std::size_t>(count));
    for (std::size_t lamp = 0; lamp < radiances.size(); ++lamp) {
      const LampSamples found = samplesOf(set, snapshot, lamp);
      INFO("lamp " << lamp << " has " << found.count);
      CHECK(found.count >= 1);
      CHECK(found.power == Approx(radiances[lamp]).epsilon(1e-5));
    }
    // Beyond one each they go by power.
    CHECK(std::abs(samplesOf(set, snapshot, 3).count - 1 - 2 * (samplesOf(set, snapshot, 1).count - 1)) <= 2);
  }
}

TEST_CASE("more lamps than samples still give all light together, the brightest first") {
  const Scene scene = rowOfLamps({1.0f, 8.0f, 1.0f});
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
