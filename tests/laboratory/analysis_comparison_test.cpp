// Pipelines set against each other: fronts, who beats whom, equal time, equal error, and which stored runs
// may be compared at all.
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "lumivox/analysis/comparison.h"
#include "lumivox/analysis/same_pipelines.h"
#include "lumivox/base/error.h"
#include "support/facts.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

/// A point with one time and, for the whole image, an error of 1 % uncertainty against full transport.
ReportPoint pointOf(const std::string& pipeline, double samples, double timeMs, double rmse) {
  ReportPoint point;
  point.scene = "scenes/room.scene";
  point.pipeline = "pipelines/" + pipeline + ".pipeline";
  point.parameters["samples"].number = samples;
  point.frameMs = {timeMs, 0.99 * timeMs, 1.01 * timeMs, 0.9 * timeMs, 1.1 * timeMs, 9};
  for (const bool bias : {true, false}) {
    ComponentError error;
    error.output = kWholeImage;
    error.component = "final";
    error.bias = bias;
    error.reference = bias ? "one_bounce" : "full";
    error.error.rmse = {bias ? 0.5 * rmse : rmse, 0.01 * rmse};
    error.seeds = 3;
    error.error.flip = rmse;
    point.errors.push_back(error);
  }
  return point;
}

/// "coarse" is quick and wrong, "fine" slow and right, "poor" is always beaten.
std::vector<ReportPoint> threePipelines() {
  return {pointOf("fine", 1, 20.0, 0.1),  pointOf("fine", 4, 80.0, 0.025), pointOf("coarse", 1, 1.0, 0.4),
          pointOf("coarse", 4, 4.0, 0.2), pointOf("poor", 1, 30.0, 0.3),   pointOf("coarse", 16, 16.0, 0.19)};
}

std::vector<const ReportPoint*> pointersTo(const std::vector<ReportPoint>& points) {
  std::vector<const ReportPoint*> pointers;
  for (const ReportPoint& point : points) pointers.push_back(&point);
  return pointers;
}

PipelineComparison compared(const std::vector<ReportPoint>& points, const ComparisonLimits& limits = {},
                            bool bias = false, const std::string& metric = "rmse") {
  return comparePipelines(pointersTo(points), "final", bias, metric, limits);
}

std::size_t pipelineNamed(const PipelineComparison& comparison, const std::string& name) {
  for (std::size_t i = 0; i < comparison.pipelines.size(); ++i)
    if (comparison.pipelines[i].pipeline == "pipelines/" + name + ".pipeline") return i;
  FAIL("no pipeline " + name);
  return 0;
}

StoredRun storedAt(const ReportPoint& point, const std::string& created, const std::string& framework) {
  StoredRun run;
  run.point = point;
  run.created = created;
  run.identity.framework = framework;
  run.identity.camera = "main";
  run.identity.width = run.identity.height = 64;
  run.identity.device = "a device";
  return run;
}

/// A point that judges its indirect light too, against its own bounces and full transport, and direct light.
ReportPoint layeredPoint(const std::string& pipeline, double samples, double timeMs, double flip) {
  ReportPoint point = pointOf(pipeline, samples, timeMs, flip);
  point.passOrder = {"gbuffer", "gather"};
  const auto add = [&](const char* component, bool bias, const char* reference, double value) {
    ComponentError error;
    error.output = error.component = component;
    error.bias = bias;
    error.reference = reference;
    error.seeds = 3;
    error.error.flip = value;
    error.error.rmse = {value, 0.01 * value};
    point.errors.push_back(error);
  };
  add("direct", true, "direct", 0.125);
  add("indirect_diffuse", true, "one_bounce_diffuse", flip);
  add("indirect_diffuse", false, "indirect_diffuse", 2.0 * flip);
  return point;
}

}  // namespace

TEST_CASE("pipelines on the Pareto front are named by frame time, a beaten one with its better") {
  const PipelineComparison comparison = compared(threePipelines());
  const std::size_t coarse = pipelineNamed(comparison, "coarse"), fine = pipelineNamed(comparison, "fine");
  const std::size_t poor = pipelineNamed(comparison, "poor");
  CHECK(comparison.hasFront(coarse));
  CHECK(comparison.hasFront(fine));
  CHECK_FALSE(comparison.hasFront(poor));
  for (const ComparedPoint& point : comparison.points)
    if (point.pipeline == poor) {
      REQUIRE(point.beatenBy);
      CHECK(comparison.points[*point.beatenBy].pipeline == fine);
    }
  REQUIRE(comparison.ranges.size() == 5);
  CHECK(comparison.ranges[0].fromMs == 1.0);
  CHECK(comparison.ranges[0].toMs == 4.0);
  // 0.2 and 0.19 with 1 % each are 3.6 standard uncertainties apart: from 16 ms on the latter is the best.
  const auto best = [&](std::size_t range) {
    return comparison.points[comparison.ranges[range].best.front()];
  };
  CHECK(best(2).tradeOff.error.value == 0.19);
  CHECK(best(3).pipeline == fine);
  CHECK(best(4).tradeOff.error.value == 0.025);
  CHECK_FALSE(comparison.ranges[4].toMs);
}

TEST_CASE("pipelines within the uncertainty of the best are told with it") {
  const PipelineComparison comparison =
      compared({pointOf("a", 1, 10.0, 0.100), pointOf("b", 1, 10.1, 0.102), pointOf("c", 1, 10.05, 0.2)});
  REQUIRE(comparison.ranges.size() == 2);
  CHECK(comparison.ranges[1].best.size() == 2);
  CHECK(comparison.hasFront(pipelineNamed(comparison, "b")));
  CHECK_FALSE(comparison.hasFront(pipelineNamed(comparison, "c")));
}

TEST_CASE("equal time and equal error follow each pipeline's own measured points and mark the best") {
  const PipelineComparison comparison = compared(threePipelines(), {{40.0, 2.0, 200.0}, {0.05, 0.3}});
  CHECK(comparison.frameTimesMs == std::vector<double>{2.0, 40.0, 200.0});
  const ComparedPipeline& coarse = comparison.pipelines[pipelineNamed(comparison, "coarse")];
  const ComparedPipeline& fine = comparison.pipelines[pipelineNamed(comparison, "fine")];
  // coarse falls from 0.4 to 0.2 between 1 and 4 ms: as the square root of the time.
  CHECK(coarse.atTime[0].reached.value.value == Approx(0.4 / std::sqrt(2.0)));
  CHECK(coarse.atTime[0].best);
  CHECK(fine.atTime[0].reached.reach == Reach::notReached);
  CHECK(fine.atTime[1].reached.value.value == Approx(0.05));  // 0.1 at 20 ms, as the inverse of the time
  CHECK(fine.atTime[1].best);
  CHECK(coarse.atTime[1].reached.reach == Reach::atMost);
  CHECK_FALSE(coarse.atTime[1].best);
  CHECK(fine.atTime[2].reached.reach == Reach::atMost);
  CHECK(fine.atError[0].reached.value.value == Approx(40.0));
  CHECK(coarse.atError[0].reached.reach == Reach::notReached);
  CHECK(coarse.atError[1].reached.value.value == Approx(std::pow(0.4 / 0.3, 2.0)));
  CHECK(fine.atError[1].reached.reach == Reach::atMost);
  CHECK(fine.atError[1].reached.value.value == 20.0);
}

TEST_CASE("a comparison knows its reference and metric, and takes in only what was timed and judged") {
  std::vector<ReportPoint> points = threePipelines();
  points.push_back(pointOf("fine", 16, 300.0, 0.001));
  points.back().failure = "it did not fit into memory";
  points.push_back(pointOf("fine", 64, 300.0, 0.001));
  points.back().frameMs.repeats = 0;
  points.push_back(pointOf("fine", 256, 300.0, 0.001));
  points.back().errors.clear();
  CHECK(compared(points).points.size() == 6);
  CHECK(compared(points).reference == "full");
  CHECK(compared(points, {}, true).reference == "one_bounce");
  CHECK(compared(points, {}, true).points[0].tradeOff.error.value == 0.2);
  CHECK(compared(points, {}, false, "flip").points[0].tradeOff.error.value == 0.4);
  CHECK(compared({}).points.empty());
  CHECK_NOTHROW(requireErrorMetric("flip"));
  CHECK_THROWS_MATCHES(requireErrorMetric("ssim"), Error, Tells("ssim", "rmse"));
  CHECK_THROWS_MATCHES(requireErrorMetric("flop"), Error, Tells("flop", "mean", "flip"));
}

TEST_CASE("one reference that answers for bias and for what is missed is compared once") {
  std::vector<ReportPoint> points = threePipelines();
  CHECK(compareComponents(pointersTo(points), {"rmse", "flip"}, {}).size() == 4);
  for (ReportPoint& point : points)
    for (ComponentError& error : point.errors) error.reference = "full";
  CHECK(compareComponents(pointersTo(points), {"rmse", "flip"}, {}).size() == 2);
}

TEST_CASE("the JSON of a comparison has every point, who beats it, and every cell of the tables") {
  const nlohmann::ordered_json json = toJson(compared(threePipelines(), {{2.0}, {0.05}}));
  CHECK(json.at("points").size() == 6);
  CHECK(json.at("points").at(0).at("on_front").get<bool>());
  CHECK(json.at("pipelines").size() == 3);
  for (const auto& pipeline : json.at("pipelines")) {
    CHECK(pipeline.at("equal_time").size() == 1);
    CHECK(pipeline.at("equal_error").size() == 1);
  }
  CHECK(json.at("ranges").size() == 5);
}

TEST_CASE("stored runs are compared on one machine and scene, the newest of each pipeline") {
  const ReportPoint a = pointOf("a", 1, 10.0, 0.1), a4 = pointOf("a", 4, 40.0, 0.05),
                    b = pointOf("b", 1, 5.0, 0.2);
  ReportPoint better = a;
  better.frameMs.median = 9.0;
  ReportPoint failed = b;
  failed.parameters["samples"].number = 4;
  failed.failure = "no memory";
  std::vector<StoredRun> runs{storedAt(a4, "2026-01-01", "old"), storedAt(a, "2026-01-02", "new"),
                              storedAt(b, "2026-01-02", "old"), storedAt(better, "2026-01-03", "new"),
                              storedAt(failed, "2026-01-03", "old")};
  StoredRun elsewhere = storedAt(a, "2026-01-04", "new");
  elsewhere.identity.device = "another device";
  runs.push_back(elsewhere);
  const std::vector<ComparableRuns> groups = comparableRuns(runs);
  REQUIRE(groups.size() == 2);
  const auto& here = groups[0].runs.size() == 2 ? groups[0] : groups[1];
  REQUIRE(here.runs.size() == 2);
  CHECK(here.passedOver == 3);
  CHECK(here.title == "room, camera main, 64x64, on a device");
  for (const StoredRun* run : here.runs)
    if (run->point.pipeline == a.pipeline) CHECK(run->point.frameMs.median == 9.0);
}

TEST_CASE("indirect light against its own bounces leads, apart from what is equal for all") {
  const std::vector<ReportPoint> points{layeredPoint("a", 1, 1.0, 0.2), layeredPoint("b", 1, 2.0, 0.1)};
  const auto comparisons = compareComponents(pointersTo(points), {"rmse", kDefaultMetric}, {});
  const auto led = ledComparison(comparisons);
  REQUIRE(led);
  CHECK(comparisons[*led].component == "indirect_diffuse");
  CHECK(comparisons[*led].bias);
  CHECK(comparisons[*led].metric == kDefaultMetric);
  for (const PipelineComparison& one : comparisons) CHECK(one.equalForAll == (one.component == "direct"));
  CHECK(comparableComponents().front() == "indirect_diffuse");
  CHECK(comparableComponents().back() == "final");
}

TEST_CASE("the whole image against full transport leads where no indirect light tells pipelines apart") {
  const std::vector<ReportPoint> direct{pointOf("a", 1, 1.0, 0.2), pointOf("b", 1, 2.0, 0.1)};
  const auto whole = compareComponents(pointersTo(direct), {kDefaultMetric}, {});
  REQUIRE(ledComparison(whole));
  CHECK(whole[*ledComparison(whole)].component == "final");
  CHECK_FALSE(whole[*ledComparison(whole)].bias);
  // One pipeline alone has nothing to be told apart from.
  const std::vector<ReportPoint> one{layeredPoint("a", 1, 1.0, 0.2)};
  const auto alone = compareComponents(pointersTo(one), {kDefaultMetric}, {});
  CHECK(alone[*ledComparison(alone)].component == "final");
  CHECK_FALSE(ledComparison({}));
}

TEST_CASE("a pipeline that comes to the same passes as another one is left out of comparisons and named") {
  std::vector<ReportPoint> points{layeredPoint("smoke", 1, 1.1, 0.2), layeredPoint("cones", 1, 1.0, 0.2),
                                  layeredPoint("cones", 4, 4.0, 0.1), layeredPoint("smoke", 2, 1.2, 0.2)};
  for (const std::size_t smoke : {0u, 3u}) {
    points[smoke].parameters["steps"].number = 8.0 * static_cast<double>(smoke);
    points[smoke].passOrder = {"gather", "gbuffer"};  // passes that need nothing of each other
  }
  const auto same = samePipelines(pointersTo(points));
  REQUIRE(same.size() == 1);
  CHECK(same.at("pipelines/smoke.pipeline") == "pipelines/cones.pipeline");
  const PipelineComparison comparison = comparePipelines(pointersTo(points), "final", false, "flip", {});
  CHECK(comparison.pipelines.size() == 1);
  CHECK(comparison.points.size() == 2);
  CHECK(comparison.same == same);
  CHECK(toJson(comparison).at("same").at("pipelines/smoke.pipeline") == "pipelines/cones.pipeline");

  const auto differs = [&](const std::function<void(ReportPoint&)>& change) {
    std::vector<ReportPoint> others = points;
    change(others[3]);
    return samePipelines(pointersTo(others)).empty();
  };
  CHECK(differs([](ReportPoint& point) { point.passOrder.emplace_back("smoke"); }));
  CHECK(differs([](ReportPoint& point) { point.passWork["gather"]["samples"] = 12.0; }));
  CHECK(differs([](ReportPoint& point) { point.errors[1].error.flip += 1e-12; }));
}
