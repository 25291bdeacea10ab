// Equal time and equal error between measured points: closed forms on power laws, uncertainties against
// random draws, and the rule of the front.
#include <cmath>
#include <random>

#include "lumivox/analysis/interpolation.h"
#include "support/support.h"

using namespace lumivox;

namespace {

TradeOff at(double timeMs, double error, double timeUncertainty = 0.0, double errorUncertainty = 0.0) {
  return {{timeMs, timeUncertainty}, {error, errorUncertainty}};
}

std::vector<TradeOff> powerLaw(double factor, double exponent) {
  std::vector<TradeOff> points;
  for (const double time : {1.0, 3.0, 4.0, 20.0})
    points.push_back(at(time, factor * std::pow(time, exponent)));
  return points;
}

double errorAt(const std::vector<TradeOff>& points, double timeMs) {
  return errorAtTime(points, frontByValue(points), timeMs).value.value;
}

/// Relative spread of what the interpolation gives when its points are drawn from their uncertainties. With
/// `sharedNoise` all errors move together, as they do by the noise of one reference.
template <class Interpolate>
double drawnSpread(const std::vector<TradeOff>& points, bool sharedNoise, Interpolate interpolate) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  double sum = 0.0, squares = 0.0;
  constexpr int kDraws = 100000;
  for (int draw = 0; draw < kDraws; ++draw) {
    std::vector<TradeOff> drawn = points;
    const double shared = normal(random);
    for (TradeOff& point : drawn) {
      point.timeMs.value += normal(random) * point.timeMs.uncertainty;
      point.error.value += (sharedNoise ? shared : normal(random)) * point.error.uncertainty;
    }
    const double value = std::log(interpolate(drawn));
    sum += value;
    squares += value * value;
  }
  const double mean = sum / kDraws;
  return std::sqrt(squares / kDraws - mean * mean);
}

}  // namespace

TEST_CASE("between measured points a power law of error against time is met exactly, both ways") {
  const std::vector<TradeOff> points = powerLaw(0.3, -0.7);
  const std::vector<std::size_t> front = frontByValue(points);
  for (const double time : {1.0, 1.5, 3.0, 3.7, 4.0, 11.0, 20.0}) {
    const double error = 0.3 * std::pow(time, -0.7);
    const Interpolated forward = errorAtTime(points, front, time);
    CHECK(forward.reach == Reach::interpolated);
    CHECK(forward.value.value == Approx(error).epsilon(1e-12));
    const Interpolated back = timeAtError(points, front, error);
    CHECK(back.value.value == Approx(time).epsilon(1e-12));
  }
}

TEST_CASE("nothing is extrapolated: not reached below all points, at most above them") {
  const std::vector<TradeOff> points = powerLaw(1.0, -1.0);
  const std::vector<std::size_t> front = frontByValue(points);
  CHECK(errorAtTime(points, front, 0.99).reach == Reach::notReached);
  const Interpolated late = errorAtTime(points, front, 21.0);
  CHECK(late.reach == Reach::atMost);
  CHECK(late.value.value == 0.05);
  CHECK(timeAtError(points, front, 0.049).reach == Reach::notReached);
  const Interpolated easy = timeAtError(points, front, 1.01);
  CHECK(easy.reach == Reach::atMost);
  CHECK(easy.value.value == 1.0);
  CHECK(errorAtTime({}, {}, 1.0).reach == Reach::notMeasured);
  const std::vector<TradeOff> one{at(2.0, 0.1)};
  CHECK(errorAtTime(one, {0}, 1.0).reach == Reach::notReached);
  CHECK(errorAtTime(one, {0}, 2.0).value.value == 0.1);
  CHECK(errorAtTime(one, {0}, 3.0).reach == Reach::atMost);
}

TEST_CASE("a point with more time and more error than another does not bend its pipeline's interpolation") {
  std::vector<TradeOff> points{at(1.0, 1.0), at(10.0, 2.0), at(100.0, 0.01)};
  CHECK(frontByValue(points) == std::vector<std::size_t>{0, 2});
  CHECK(errorAt(points, 10.0) == Approx(0.1));
  points.push_back(at(0.0, 0.5));  // not timed
  points.push_back(at(5.0, 0.0));  // no error to take the logarithm of
  CHECK(frontByValue(points) == std::vector<std::size_t>{0, 2});
}

TEST_CASE("the uncertainty of an interpolated value is that of random draws") {
  const std::vector<TradeOff> points{at(10.0, 0.2, 0.2, 0.004), at(40.0, 0.05, 1.2, 0.002)};
  const std::vector<std::size_t> front{0, 1};
  const auto check = [&](const auto& interpolate) {
    const Measured found = interpolate(points);
    const auto value = [&](const std::vector<TradeOff>& drawn) { return interpolate(drawn).value; };
    CHECK(found.uncertainty / found.value == Approx(drawnSpread(points, true, value)).epsilon(0.03));
    return found.uncertainty / found.value - drawnSpread(points, false, value);
  };
  for (const double time :
       {12.0, 20.0, 33.0})  // independent errors spread less: the formula is on the safe side
    CHECK(check([&](const std::vector<TradeOff>& drawn) { return errorAtTime(drawn, front, time).value; }) >
          0.0);
  for (const double error : {0.17, 0.1, 0.06})
    check([&](const std::vector<TradeOff>& drawn) { return timeAtError(drawn, front, error).value; });
}

TEST_CASE("at a measured point the uncertainty is that of its error, and of its time through the slope") {
  const std::vector<TradeOff> points{at(1.0, 1.0, 0.01, 0.02), at(100.0, 0.01, 0.0, 0.0)};  // slope -1
  const Measured error = errorAtTime(points, {0, 1}, 1.0).value;
  CHECK(error.uncertainty == Approx(std::hypot(0.02, 0.01)));
  const Measured exact = errorAtTime(points, {0, 1}, 100.0).value;
  CHECK(exact.uncertainty == Approx(0.0).margin(1e-12));
}

TEST_CASE("two times that lie within their uncertainty do not blow up the error between them") {
  const std::vector<TradeOff> points{at(10.0, 0.2, 0.5), at(10.001, 0.1, 0.5)};
  const Measured error = errorAtTime(points, {0, 1}, 10.0005).value;
  CHECK(error.value > 0.1);
  CHECK(error.value < 0.2);
  CHECK(error.uncertainty <= error.value * std::log(2.0) * 1.0001);
}

TEST_CASE("a point is beaten when another is as good in both and clearly better in one") {
  const TradeOff here = at(10.0, 0.1, 0.1, 0.001);
  const auto [ms, error, beaten] = GENERATE(table<double, double, bool>({
      {5.0, 0.1, true},
      {10.0, 0.05, true},
      {9.99, 0.05, true},
      {5.0, 0.1001, false},  // more error, however little
      {10.01, 0.05, false},  // slower, however little
      {10.0, 0.1, false},
  }));
  CHECK(beats(at(ms, error, 0.1, 0.001), here) == beaten);
}

TEST_CASE("of too few repeats nothing is beaten, and a machine's mood is no difference") {
  const TradeOff here = at(10.0, 0.1, 0.1, 0.001);
  TradeOff quick = at(5.0, 0.1, 0.1, 0.001);
  CHECK(beats(quick, here));
  CHECK_FALSE(beats(quick, here, 0.6));  // the same point was found 60 % apart
  quick.timeMs.enoughRepeats = false;
  CHECK_FALSE(beats(quick, here));
  TradeOff right = at(10.0, 0.05, 0.1, 0.001);
  CHECK(beats(right, here));
  right.error.enoughRepeats = false;
  CHECK_FALSE(beats(right, here));
  // A value interpolated from it is as undecided.
  CHECK_FALSE(errorAtTime({at(5.0, 0.2), right}, {0, 1}, 7.0).value.enoughRepeats);
  CHECK(errorAtTime({at(5.0, 0.2), here}, {0, 1}, 7.0).value.enoughRepeats);
  CHECK_FALSE(medianOf(statisticsOf({1.0, 2.0})).enoughRepeats);
  CHECK(medianOf(statisticsOf({1.0, 2.0, 3.0})).enoughRepeats);
}

TEST_CASE("two points within their uncertainties are both on the Pareto front") {
  const TradeOff here = at(10.0, 0.1, 0.1, 0.01);
  CHECK_FALSE(beats(at(9.9, 0.099, 0.1, 0.01), here));
  CHECK_FALSE(beats(at(9.7, 0.1, 0.0, 0.01), here));  // certain, but within 5 % of the time
  const auto front = beatenBy({here, at(9.9, 0.099, 0.1, 0.01), at(20.0, 0.5, 0.1, 0.01)});
  CHECK_FALSE(front[0]);
  CHECK_FALSE(front[1]);
  CHECK(front[2] == std::size_t{1});
}

TEST_CASE("of points within noise of the least, the one with the least other number is chosen") {
  // Errors of 0.378 at 35 ms and 0.379 at 17 ms; the third is certainly worse, the last does not fit.
  const std::vector<TradeOff> points{at(35.3, 0.378, 0.1, 0.001), at(17.3, 0.379, 0.1, 0.001),
                                     at(10.0, 0.39, 0.1, 0.001), at(90.0, 0.1, 0.1, 0.001)};
  const std::vector<std::size_t> fitting{0, 1, 2};
  CHECK(leastOf(points, fitting, &TradeOff::error) == std::size_t{0});
  CHECK(leastWithinNoise(points, fitting, &TradeOff::error) == std::size_t{1});
  CHECK(leastWithinNoise(points, {0, 2}, &TradeOff::error) == std::size_t{0});
  CHECK_FALSE(leastWithinNoise(points, {}, &TradeOff::error));
  // The other way round: a time within 5 % is the same, and the least error decides.
  const std::vector<TradeOff> quick{at(10.0, 0.4), at(10.4, 0.2), at(10.6, 0.1)};
  CHECK(leastWithinNoise(quick, {0, 1, 2}, &TradeOff::timeMs) == std::size_t{1});
  CHECK(leastWithinNoise(quick, {0, 1, 2}, &TradeOff::timeMs, 0.1) == std::size_t{2});
}

TEST_CASE("what has too few repeats is not chosen for another, nor another for it") {
  std::vector<TradeOff> points{at(35.3, 0.378, 0.1, 0.001), at(17.3, 0.379, 0.1, 0.001)};
  points[1].error.enoughRepeats = false;
  CHECK(leastWithinNoise(points, {0, 1}, &TradeOff::error) == std::size_t{0});
  std::swap(points[0].error.enoughRepeats, points[1].error.enoughRepeats);
  CHECK(leastWithinNoise(points, {0, 1}, &TradeOff::error) == std::size_t{0});
}

TEST_CASE("frame times of tables are round numbers within what was measured") {
  CHECK(roundNumbers(0.9, 60.0) == std::vector<double>{1, 2, 5, 10, 20, 50});
  CHECK(roundNumbers(0.02, 0.2) == std::vector<double>{0.02, 0.05, 0.1, 0.2});
  CHECK(roundNumbers(10.0, 21.0) == std::vector<double>{10, 15, 20});
  const std::vector<double> narrow = roundNumbers(0.2041, 0.2079);
  REQUIRE(narrow.size() == 3);
  CHECK(narrow[0] == Approx(0.205));
  CHECK(narrow[2] == Approx(0.207));
  CHECK(roundNumbers(3.0, 3.01).empty());
  CHECK(roundNumbers(0.0, 1.0).empty());
  CHECK(roundNumbers(2.0, 1.0).empty());
}

TEST_CASE("the standard error of a median comes from the quartiles and shrinks with the repeats") {
  // A normal distribution of sigma 2 has its quartiles 0.6745 sigma from the median.
  TimingStatistics time{10.0, 10.0 - 1.349, 10.0 + 1.349, 5.0, 15.0, 25};
  CHECK(medianOf(time).value == 10.0);
  CHECK(medianOf(time).uncertainty == Approx(1.2533 * 2.0 / 5.0));
  time.repeats = 100;
  CHECK(medianOf(time).uncertainty == Approx(1.2533 * 2.0 / 10.0));
  CHECK(medianOf(TimingStatistics{}).uncertainty == 0.0);
}
