// Health and repeated timings on vectors computed by hand.
#include <tbb/global_control.h>

#include <cmath>
#include <limits>

#include "lumivox/base/error.h"
#include "lumivox/base/random.h"
#include "lumivox/measure/metrics.h"
#include "support/support.h"

using namespace lumivox;

TEST_CASE("a health scan counts NaN, infinite and negative values and names the first") {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(),
                  kInfinity = std::numeric_limits<float>::infinity();
  const std::vector<float> values = {1, 2, 3, -1, 0, -0.0f, -2, kInfinity, -kInfinity, kNan, 5, 1};
  const Health health = scanHealth(values.data(), values.size(), 4);
  CHECK((health.nan == 1 && health.infinite == 2 && health.negative == 2));
  CHECK(health.firstBad == 3);
  CHECK(health.sum == Approx(1 + 2 + 3 - 1 - 2 + 5 + 1));
  CHECK(health.largest == 5.0);
  CHECK_FALSE(health.good());
  // The fourth of every four numbers is alpha: -1, infinity and the last 1 are passed over.
  const Health radiance = scanHealth(values.data(), values.size(), 4, false);
  CHECK((radiance.nan == 1 && radiance.infinite == 1 && radiance.negative == 1));
  CHECK(radiance.firstBad == 6);
  CHECK(radiance.sum == Approx(1 + 2 + 3 - 2 + 5));
  const std::vector<float> good = {0.0f, -0.0f, 1.0f};
  CHECK(scanHealth(good.data(), good.size(), 1).good());
  CHECK(scanHealth(good.data(), good.size(), 1).firstBad == -1);
  CHECK(scanHealth(nullptr, 0, 1).good());
  const float negative = -3.0f;
  CHECK(scanHealth(&negative, 1, 1).largest == -3.0);
}

TEST_CASE("a scan of a large grid finds its one bad value and the same sum on any number of threads") {
  std::vector<float> values(1'000'003);
  RandomStream stream(1, 1);
  for (float& value : values) value = stream.uniform();
  values[777'777] = -1e-30f;
  const Health many = scanHealth(values.data(), values.size(), 1);
  CHECK(many.negative == 1);
  CHECK(many.firstBad == 777'777);
  const tbb::global_control single(tbb::global_control::max_allowed_parallelism, 1);
  CHECK(scanHealth(values.data(), values.size(), 1).sum == many.sum);
}

TEST_CASE("median and quartiles are interpolated between the sorted values") {
  // Sorted 1 2 4 8: the places are 0.75, 1.5 and 2.25.
  const TimingStatistics four = statisticsOf({8, 1, 4, 2});
  CHECK(four.lowerQuartile == Approx(1.75));
  CHECK(four.median == Approx(3.0));
  CHECK(four.upperQuartile == Approx(5.0));
  CHECK((four.smallest == 1.0 && four.largest == 8.0 && four.repeats == 4));
  const TimingStatistics five = statisticsOf({5, 4, 3, 2, 1});
  CHECK((five.lowerQuartile == 2.0 && five.median == 3.0 && five.upperQuartile == 4.0));
  const TimingStatistics one = statisticsOf({7});
  CHECK((one.lowerQuartile == 7.0 && one.median == 7.0 && one.upperQuartile == 7.0 && one.repeats == 1));
  CHECK(statisticsOf({}).repeats == 0);
}

TEST_CASE("the mean over seeds has the standard error of the mean") {
  // 1, 2, 3, 6: mean 3, squares 4 + 1 + 0 + 9 = 14, variance 14 / 3, error of the mean sqrt(14 / 12).
  const Measured mean = meanOverSeeds({1, 2, 3, 6});
  CHECK(mean.value == Approx(3.0));
  CHECK(mean.uncertainty == Approx(std::sqrt(14.0 / 12.0)));
  CHECK(meanOverSeeds({4}).value == 4.0);
  CHECK(meanOverSeeds({4}).uncertainty == 0.0);
  CHECK(std::isnan(meanOverSeeds({}).value));
}
