// Techniques that go on from frame to frame, or model several bounces: what they are judged by, and what
// their time is.
#include <fmt/format.h>

#include <cmath>

#include "experiment/choice.h"
#include "experiment/measure.h"
#include "experiment/turns.h"
#include "framework/pipeline_toys.h"
#include "lumivox/analysis/slopes.h"
#include "support/facts.h"
#include "support/scene_builder.h"
#include "support/techniques.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

constexpr float kDirect = 1.0f;

/// A pass whose image comes nearer to the reference with every frame.
struct Progressive : Toy {
  using Toy::Toy;
  Out<Image> radiance{this, "radiance", Contributes::direct};
  Reads readsFrom() const override { return Reads::camera | Reads::history; }
  void run(PassContext& frame) override {
    note();
    radiance = paint(frame, kDirect + 0.5f / static_cast<float>(1 + frame.accumulated()));
  }
};

/// A pass that goes on from the last frame only where its text binds that.
struct GoesOn : Toy {
  using Toy::Toy;
  In<Image> before{this, "before", Presence::history, "the last frame's image"};
  Out<Image> radiance{this, "radiance", Contributes::direct};
  Reads readsFrom() const override { return Reads::camera; }
  void run(PassContext& frame) override { radiance = paint(frame, kDirect); }
};

/// The pixel of an upright or level edge: 1 where its ray passes before it.
struct Edge : Toy {
  using Toy::Toy;
  Param<float> at{this, "at", 0.5f, {0.0f, 1.0f}, "", "of the pixel lies before the edge"};
  Param<bool> level{this, "level", false, "whether it is level"};
  Out<Image> radiance{this, "radiance", Contributes::direct};
  Reads readsFrom() const override { return Reads::camera; }
  void run(PassContext& frame) override {
    const glm::vec2 shift = frame.snapshot().camera.shift;
    radiance = paint(frame, (level ? shift.y : shift.x) + 0.5f < at ? 1.0f : 0.0f);
  }
};

/// The light of two bounces in a furnace of albedo a and emission 1, where a is direct light: a² + a³.
struct TwoBounces : Toy {
  using Toy::Toy;
  Out<Image> radiance{this, "radiance", Contributes::indirectDiffuse};
  Reads readsFrom() const override { return Reads::camera; }
  int indirectBounces() const override { return 2; }
  void run(PassContext& frame) override { radiance = paint(frame, 0.25f + 0.125f); }
};

Pipeline toyPipeline(const std::string& pass, const std::string& output, const std::string& bound = "") {
  return Pipeline::parse("pipeline \"Toy\" {\n  pass a toys." + pass + " { " + bound + " }\n  output " +
                             output + " a.radiance\n}\n",
                         "toy.pipeline");
}

struct Toys : TestTechniques {
  Toys() {
    add<Progressive>("toys", "progressive");
    add<TwoBounces>("toys", "two_bounces");
    add<GoesOn>("toys", "goes_on");
    add<Edge>("toys", "edge");
    add<Paint>("toys", "paint");
  }
};

Scene furnace(float albedo) {
  SceneBuilder builder;
  builder.box({-1, -1, -1}, {1, 1, 1}, builder.lambert(albedo, 1.0f), true);
  builder.look({0, 0, 0.5}, {0, 0, -1}, {0, 1, 0}, 1.0, 12, 8);
  return builder.scene;
}

ReportPoint measured(Toys& toys, const Scene& scene, const Pipeline& pipeline, int frames,
                     int subpixels = 2) {
  ReportOptions options;
  options.subpixels = subpixels;
  options.seeds = 2;
  ReferenceOptions referenceOptions = quietly(64);
  referenceOptions.width = 12;
  referenceOptions.height = 8;
  experiment::SceneReference reference(scene, referenceOptions);
  const experiment::MeasureContext context{{device(), toys, scene, options, 12, 8}, reference};
  PointRecord record;
  if (frames > 1) record.point.parameters[kAccumulatedFrames].number = frames;
  experiment::measureErrors(context, pipeline, record);
  return record.point;
}

}  // namespace

TEST_CASE("a progressive pipeline is judged by its last frame, accumulated from nothing") {
  Toys toys;
  const Scene scene = furnace(0.0f);
  const Pipeline pipeline = toyPipeline("progressive", "direct");
  for (const int frames : {1, 2, 5}) {
    const ReportPoint point = measured(toys, scene, pipeline, frames);
    INFO(frames);
    REQUIRE_FALSE(point.errors.empty());
    CHECK(point.errors.front().error.rmse.value == Approx(0.5 / frames).epsilon(1e-3));
  }
}

TEST_CASE("a judged image covers upright and level edges within half of one of its positions in the pixel") {
  Toys toys;
  const Scene scene = furnace(0.0f);
  for (const char* level : {"off", "on"})
    for (const float at : {0.06f, 0.21f, 0.48f, 0.5f, 0.73f, 0.97f}) {
      const Pipeline pipeline = Pipeline::parse(
          fmt::format(
              "pipeline \"Edge\" {{\n  pass a toys.edge {{ at {}  level {} }}\n  output direct a.radiance\n}}\n",
              at, level),
          "edge.pipeline");
      RenderOptions options;
      options.width = 12;
      options.height = 8;
      options.interactive = true;
      PipelineExecutor executor(device(), toys, scene, pipeline, options);
      const FrameResult frame =
          experiment::renderFiltered(executor, snapshotOf(scene, 0.0, {}, 12, 8), 16, 0, 1);
      INFO(level << " " << at);
      CHECK(std::abs(frame.outputs.at("direct").at(0, 0, 0) - at) <= 0.5f / 16.0f + 1e-3f);
    }
}

TEST_CASE("four positions are enough where more would change nothing, and an edge is judged at all of them") {
  Toys toys;
  const Scene scene = furnace(0.0f);
  const ReportPoint flat = measured(toys, scene, toyPipeline("progressive", "direct"), 1, 16);
  CHECK(flat.subpixels == 4);
  for (const ComponentError& error : flat.errors) CHECK(error.error.rmse.value == Approx(0.5).epsilon(1e-3));
  // Of four positions three lie before the edge, of sixteen thirteen; all of the reference is 1.
  const Pipeline edge = Pipeline::parse(
      "pipeline \"Edge\" {\n  pass a toys.edge { at 0.8 }\n  output direct a.radiance\n}\n", "edge.pipeline");
  const ReportPoint judged = measured(toys, scene, edge, 1, 16);
  REQUIRE(judged.errors.size() >= 2);  // of the output and of the whole image
  for (const ComponentError& error : judged.errors) {
    INFO(error.output);
    CHECK(error.error.rmse.value == Approx(3.0 / 16.0).epsilon(1e-3));
  }
  for (const ComponentError& error : measured(toys, scene, edge, 1, 4).errors)
    CHECK(error.error.rmse.value == Approx(0.25).epsilon(1e-3));
}

TEST_CASE("the time of a point of several frames is that of all of them, from nothing in each repeat") {
  Toys toys;
  const Scene scene = furnace(0.0f);
  const Pipeline pipeline = toyPipeline("progressive", "direct");
  const ReportOptions options;
  const experiment::TimingContext context{device(), toys, scene, options, 12, 8};
  for (const int frames : {1, 4}) {
    ReportPoint point;
    if (frames > 1) point.parameters[kAccumulatedFrames].number = frames;
    experiment::TimedPoint timed(context, pipeline, point);
    toys.takeRan();
    timed.timeFrame();
    // Frames alone, and again with the passes' instruments.
    CHECK(toys.takeRan().size() == 2u * static_cast<std::size_t>(frames));
    timed.timeFrame();
    timed.timeStillFrame();
    timed.timeMovedFrame();
    timed.finish();
    CHECK(point.frameMs.repeats == 2);
    CHECK(point.passDeviceMs.at("a").repeats == 2);
    CHECK(point.stillFrameMs.repeats == 1);
    CHECK(point.movedFrameMs.repeats == 1);
  }
}

TEST_CASE("points after more and more frames are planned for progressive pipelines alone") {
  Toys toys;
  const auto framesIn = [&](const std::string& pass, int most, const std::vector<Sweep>& sweeps = {},
                            const std::string& bound = "") {
    ReportOptions options;
    options.frames = most;
    Pipeline pipeline = toyPipeline(pass, "direct", bound);
    pipeline.sweeps = sweeps;
    const experiment::LoadedPipeline loaded = experiment::withSettings(pipeline, {});
    std::vector<int> frames;
    for (const experiment::PlannedPoint& point : experiment::pointsFor(loaded, toys, options)) {
      frames.push_back(framesOf(point.parameters));
      CHECK(point.isDefault == (frames.back() == 1));
    }
    return frames;
  };
  CHECK(framesIn("progressive", 6) == std::vector<int>{1, 2, 4, 6});
  CHECK(framesIn("progressive", 1) == std::vector<int>{1});
  CHECK(framesIn("paint", 6) == std::vector<int>{1});
  CHECK(framesIn("goes_on", 6) == std::vector<int>{1});
  CHECK(framesIn("goes_on", 6, {}, "before a.radiance") == std::vector<int>{1, 2, 4, 6});
  // An axis of frames in a sweep: others go without it, and say so.
  ParameterValue one, four;
  one.number = 1.0;
  four.number = 4.0;
  const Sweep steps{"steps", false, {{kAccumulatedFrames, {one, four}}}, {}};
  CHECK(framesIn("progressive", ReportOptions().frames, {steps}) == std::vector<int>{1, 4});
  CHECK(framesIn("paint", ReportOptions().frames, {steps}) == std::vector<int>{1});
  CHECK_THAT(experiment::withoutFrames(toyPipeline("paint", "direct"), {steps}, false),
             Tells("without", "frames"));
  CHECK(experiment::withoutFrames(toyPipeline("paint", "direct"), {steps}, true).empty());
}

TEST_CASE("an output of two bounces has its bias against two, its misses against all light") {
  Toys toys;
  const ReportPoint point = measured(toys, furnace(0.5f), toyPipeline("two_bounces", "indirect"), 1);
  std::map<std::string, Measured> difference;  // of the means; the reference has noise
  for (const ComponentError& error : point.errors)
    if (error.output == "indirect") difference[error.reference] = error.error.bias;
  REQUIRE(difference.size() == 2);
  const Measured bias = difference.at("bounces_2_diffuse"), missing = difference.at("indirect_diffuse");
  CHECK(bias.value == Approx(0.0).margin(4.0 * bias.uncertainty));
  CHECK(missing.value == Approx(-0.125).margin(4.0 * missing.uncertainty));  // a² + a³ - a² / (1 - a)
  CHECK(missing.uncertainty < 0.05);
  for (const ComponentError& error : point.errors)
    if (error.output == kWholeImage && error.bias) CHECK(error.reference == "bounces_2");
}

TEST_CASE("convergence over frames begins with the point that says nothing of frames") {
  std::vector<ReportPoint> points;
  for (const int frames : {1, 2, 4, 8}) {
    ReportPoint point;
    point.pipeline = "toy.pipeline";
    if (frames > 1) point.parameters[kAccumulatedFrames].number = frames;
    ComponentError error;
    error.output = "direct";
    error.error.rmse.value = 1.0 / std::sqrt(frames);
    point.errors = {error};
    points.push_back(point);
  }
  std::vector<const ReportPoint*> all;
  for (const ReportPoint& point : points) all.push_back(&point);
  const std::vector<SweepSlope> slopes = slopesOf(all);
  REQUIRE(slopes.size() == 1);
  CHECK(slopes[0].parameter == "frames");
  CHECK(slopes[0].low == 1.0);
  CHECK(slopes[0].law.slope.value == Approx(-0.5));
}

TEST_CASE("what a frame costs is taken apart: once, when something moves, every time") {
  ReportPoint point;
  CHECK(std::isnan(costParts(point).everyFrameMs.value));
  point.frameMs = statisticsOf({10.0, 10.0, 10.0});
  point.movedFrameMs = statisticsOf({4.0, 4.0, 4.0});
  point.stillFrameMs = statisticsOf({1.0, 1.0, 1.0});
  const CostParts parts = costParts(point);
  CHECK(parts.onceMs.value == 6.0);
  CHECK(parts.movingMs.value == 3.0);
  CHECK(parts.everyFrameMs.value == 1.0);
  point.movedFrameMs = statisticsOf({0.5, 0.5, 0.5});  // a machine's mood
  CHECK(costParts(point).movingMs.value == 0.0);
  point.parameters[kAccumulatedFrames].number = 4;
  CHECK(std::isnan(costParts(point).onceMs.value));
  CHECK(costParts(point).everyFrameMs.value == 1.0);
}
