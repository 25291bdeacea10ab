// The one estimate of remaining time, on made-up costs.
#include <cmath>
#include <limits>
#include <vector>

#include "experiment/costs.h"
#include "experiment/measurer.h"
#include "experiment/reproduction_steps.h"
#include "support/scene_builder.h"
#include "support/techniques.h"

using namespace lumivox;
using namespace lumivox::test;
using experiment::Costs;

namespace {

struct Step {
  std::string subject, work;
  double weight = 1.0, seconds = 0.0;
};

/// What is estimated for the rest after each part, over what it takes.
std::vector<double> ratios(const std::vector<Step>& parts) {
  Costs costs;
  std::vector<double> result;
  for (std::size_t done = 1; done < parts.size(); ++done) {
    const Step& last = parts[done - 1];
    costs.add(last.subject, last.work, last.weight, last.seconds);
    double estimate = 0.0, truth = 0.0;
    for (std::size_t i = done; i < parts.size(); ++i) {
      estimate += costs.expected(parts[i].subject, parts[i].work, parts[i].weight)
                      .value_or(std::numeric_limits<double>::quiet_NaN());
      truth += parts[i].seconds;
    }
    result.push_back(estimate / truth);
  }
  return result;
}

/// The points of pipelines with these frames, s: so many frames each, and a time beside them, of which not
/// more is known in advance than what is usual.
std::vector<Step> pointsOf(const std::vector<double>& frames) {
  const std::vector<double> counts{11.0, 18.0, 9.0, 14.0, 10.0, 17.0}, beside{0.8, 1.3, 0.7, 1.0, 1.2, 0.9};
  std::vector<Step> parts;
  for (std::size_t i = 0; i < frames.size(); ++i)
    parts.push_back({"pipeline " + std::to_string(i), "point", 14.0 * frames[i] + 1.0,
                     counts[i % counts.size()] * frames[i] + beside[i % beside.size()]});
  return parts;
}

}  // namespace

TEST_CASE("the time left follows the frames of dearer pipelines to come, from the third on") {
  const std::vector<double> frames{0.02, 0.03, 0.05, 0.2, 0.5, 1.2};
  const std::vector<Step> parts = pointsOf(frames);
  const std::vector<double> told = ratios(parts);
  for (std::size_t i = 2; i < told.size(); ++i) {
    CAPTURE(i, told[i]);
    CHECK(told[i] > 0.5);
    CHECK(told[i] < 2.0);
  }
  // The mean of those before says far less.
  double before = 0.0, after = 0.0;
  for (std::size_t i = 0; i < parts.size(); ++i) (i < 3 ? before : after) += parts[i].seconds;
  CHECK(before / after < 0.25);
}

TEST_CASE("points of a sweep cost what those of their pipeline did") {
  std::vector<Step> parts{{"cheap", "point", 1.0, 1.0}, {"dear", "point", 1.0, 20.0}};
  for (int i = 0; i < 30; ++i) parts.push_back({"cheap", "point", 1.0, 1.1});
  for (int i = 0; i < 10; ++i) parts.push_back({"dear", "point", 1.0, 19.0});
  const std::vector<double> told = ratios(parts);
  for (std::size_t i = 2; i < told.size(); ++i) {
    CAPTURE(i, told[i]);
    CHECK(told[i] > 0.8);
    CHECK(told[i] < 1.25);
  }
}

TEST_CASE("a new work on a subject costs in proportion to its other works") {
  Costs costs;
  costs.add("slow", "errors", 1.0, 30.0);
  costs.add("quick", "errors", 1.0, 10.0);
  CHECK_FALSE(costs.expected("slow", "times", 1.0).has_value());
  costs.add("quick", "times", 1.0, 2.0);
  CHECK(costs.expected("quick", "times", 1.0).value() == 2.0);
  // Three times as dear; what is known of both works of the quick one together says a little less.
  const double slow = costs.expected("slow", "times", 1.0).value();
  CHECK(slow > 5.0);
  CHECK(slow <= 6.0);
  const double unknown = costs.expected("unknown", "times", 2.0).value();
  CHECK(unknown > 7.0);
  CHECK(unknown <= 8.0);
  CHECK_FALSE(costs.most("slow", "times", 1.0).has_value());
  costs.add("quick", "times", 1.0, 6.0);
  CHECK(costs.expected("quick", "times", 1.0).value() == 4.0);
  CHECK(costs.most("quick", "times", 2.0).value() == 12.0);
}

TEST_CASE("a reproduction tells no time before a step of each kind, panels included") {
  ReproduceOptions options;
  options.repeats = 5;
  std::vector<double> told;
  options.progress = [&](std::size_t, std::size_t, double secondsLeft) { told.push_back(secondsLeft); };
  experiment::ReproductionSteps steps(options, false);
  using Clock = experiment::ReproductionSteps::Clock;
  const auto before = [](double seconds) {
    return Clock::now() - std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  };
  steps.expect({"a", "b"}, {false, true, true});
  steps.opened("a", before(1.0));
  steps.opened("b", before(1.0));
  steps.timed("a");
  steps.timed("b");
  steps.shownPanel(before(1.0));
  // Steps of a second each are done; the panels that are left are path traced, a minute each.
  for (const double left : told) CHECK(left < 0.0);
  steps.shownPanel(before(60.0));
  CHECK(told.back() > 50.0);
  CHECK(told.back() < 70.0);
  steps.shownPanel(before(60.0));
  CHECK(told.back() == 0.0);
}

TEST_CASE("the time left counts the times of the batch and dearer pipelines to come") {
  const TemporaryDirectory place;
  TechniqueSet hostile({binaryDirectory() / "tests/plugins/hostile"});
  const Scene scene = litRoom(8, 8);
  ReportOptions options;
  options.referenceSamples = 4;
  options.subpixels = 1;
  options.repeats = 3;
  options.seeds = 1;
  options.flickerPairs = 0;
  // Each pass rests for 30 ms in a frame. Six points are timed together at the end; the dearest comes after
  // them.
  std::vector<std::unique_ptr<experiment::LoadedPipeline>> pipelines;
  std::vector<experiment::WantedPoint> points;
  for (const int passes : {1, 1, 1, 1, 1, 2, 5}) {
    std::string text = "pipeline \"Rests\" {\n";
    for (int i = 0; i < passes; ++i)
      text +=
          fmt::format("  pass p{0} hostile.paint {{ deed rest  value {1} }}\n  output o{0} p{0}.radiance\n",
                      i, pipelines.size() + 1);
    const std::filesystem::path file =
        place.write(fmt::format("rests_{}.pipeline", pipelines.size()), text + "}\n");
    pipelines.push_back(
        std::make_unique<experiment::LoadedPipeline>(experiment::withSettings(Pipeline::load(file), {})));
    for (experiment::PlannedPoint& point : experiment::pointsFor(*pipelines.back(), hostile, options))
      points.push_back({pipelines.back().get(), std::move(point)});
  }
  REQUIRE(points.size() == 7);
  ResultsStore store(place.path() / "r.sqlite");
  experiment::Measurer measurer(device(), hostile, options, store, scene, "room");
  measurer.lookAt(points);
  using Clock = std::chrono::steady_clock;
  std::vector<std::pair<Clock::time_point, double>> told;
  const std::vector<StoredRun> runs = measurer.measure(points, [&](std::size_t, std::size_t) {
    told.emplace_back(Clock::now(), measurer.secondsLeft(points));
  });
  const Clock::time_point end = Clock::now();
  for (const StoredRun& run : runs) CHECK(run.point.failure.empty());
  REQUIRE(told.size() == 7);
  CHECK(told.back().second == 0.0);
  for (std::size_t i = 2; i + 1 < told.size(); ++i) {
    const double left = std::chrono::duration<double>(end - told[i].first).count();
    CAPTURE(i, told[i].second, left);
    CHECK(told[i].second > left / 2.0);
    CHECK(told[i].second < left * 2.0);
  }
}
