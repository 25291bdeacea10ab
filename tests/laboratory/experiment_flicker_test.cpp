// Flicker, noise and bias of techniques as a report measures them, on techniques that are made for it.
#include <cmath>
#include <set>

#include "experiment/measure.h"
#include "framework/pipeline_toys.h"
#include "lumivox/analysis/slopes.h"
#include "lumivox/base/random.h"
#include "lumivox/results/json.h"
#include "lumivox/results/store.h"
#include "support/scene_builder.h"
#include "support/techniques.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

constexpr float kSigma = 0.05f;

/// The furnace's radiance, with what a subclass adds; uniform noise of standard deviation kSigma.
struct Painted : Toy {
  using Toy::Toy;
  Out<Image> radiance{this, "radiance", Contributes::direct};
  Reads readsFrom() const override { return Reads::camera | Reads::time; }
  void run(PassContext& frame) override {
    Image image{frame.image("image")};
    const gpu::TextureDescription& d = image.texture->description();
    std::vector<float> values(static_cast<std::size_t>(d.width) * static_cast<std::size_t>(d.height) * 4,
                              1.0f);
    paint(frame, values);
    image.texture->uploadFloats(0, values);
    radiance = image;
  }
  virtual void paint(PassContext&, std::vector<float>&) {}

 protected:
  static void addNoise(std::vector<float>& values, std::uint64_t seed, std::uint32_t stream) {
    RandomStream random(seed, stream);
    for (float& value : values) value += kSigma * std::sqrt(12.0f) * (random.uniform() - 0.5f);
  }
};

/// Noise that is drawn anew in every frame.
struct Restless : Painted {
  using Painted::Painted;

 private:
  void paint(PassContext& frame, std::vector<float>& values) override {
    addNoise(values, frame.seed(), static_cast<std::uint32_t>(frame.frameIndex()));
  }
};

/// Noise that stays from frame to frame, and a bias.
struct Patterned : Painted {
  using Painted::Painted;

 private:
  void paint(PassContext& frame, std::vector<float>& values) override {
    addNoise(values, frame.seed(), 0);
    for (float& value : values) value += 0.02f;
  }
};

Pipeline toyPipeline(const std::string& pass) {
  return Pipeline::parse(
      "pipeline \"Toy\" {\n  pass a toys." + pass + " { }\n  output direct a.radiance\n}\n", "toy.pipeline");
}

/// Black walls that shine with radiance 1: direct light is 1 everywhere, at all times, from all places.
Scene shiningRoom(bool moves) {
  SceneBuilder builder;
  builder.box({-1, -1, -1}, {1, 1, 1}, builder.lambert(0.0f, 1.0f), true);
  builder.look({0, 0, 0.5}, {0, 0, -1}, {0, 1, 0}, 1.0, 24, 16);
  if (moves) {
    CameraKey start, end;
    start.eye = {0, 0, 0.5}, start.target = {0, 0, -1};
    end.time = 1.0, end.eye = {0.5, 0, 0.5}, end.target = {0, 0.5, -1};
    builder.scene.cameras.front().keys = {start, end};
  }
  return builder.scene;
}

ReportOptions quickOptions() {
  ReportOptions options;
  options.subpixels = 2;
  options.referenceSamples = 16;
  options.seeds = 6;
  options.flickerPairs = 3;
  return options;
}

PointRecord measured(const std::string& pass, const Scene& scene, const ReportOptions& options) {
  TestTechniques toys;
  toys.add<Painted>("toys", "still");
  toys.add<Restless>("toys", "restless");
  toys.add<Patterned>("toys", "patterned");
  ReferenceOptions referenceOptions = quietly(options.referenceSamples);
  referenceOptions.width = 24;
  referenceOptions.height = 16;
  experiment::SceneReference reference(scene, referenceOptions);
  const experiment::MeasureContext context{{device(), toys, scene, options, 24, 16}, reference};
  PointRecord record;
  record.point.pipeline = "toy.pipeline";
  experiment::measureErrors(context, toyPipeline(pass), record);
  experiment::measureFlicker(context, toyPipeline(pass), record);
  REQUIRE_FALSE(record.point.errors.empty());
  return record;
}

}  // namespace

TEST_CASE("nothing is black, but for ambient occlusion, where it is that nothing is occluded") {
  SceneBuilder builder;
  builder.quad({-9, 0, 9}, {18, 0, 0}, {0, 0, -18}, builder.lambert(0.5f, 0.25f));
  builder.look({0, 1, 0}, {0, 0, 0}, {0, 0, -1}, 0.5, 8, 8);
  experiment::SceneReference reference(builder.scene, quietly(4, 2));
  CHECK(reference.errorOfNothing("ambient_occlusion").rmse.value == 0.0);
  CHECK(reference.errorOfNothing("direct").rmse.value == Approx(0.25));
}

TEST_CASE("an image that stays right does not flicker, and a scene at rest is not asked") {
  const ReportOptions options = quickOptions();
  const Scene moving = shiningRoom(true), resting = shiningRoom(false);
  CHECK(experiment::flickers(moving, options));
  CHECK_FALSE(experiment::flickers(resting, options));
  const PointRecord still = measured("still", moving, options);
  for (const ComponentError& error : still.point.errors) CHECK(error.flicker.value == 0.0);
  for (const ComponentError& error : measured("still", resting, options).point.errors)
    CHECK(std::isnan(error.flicker.value));
  ReportOptions without = options;
  without.flickerPairs = 0;
  CHECK_FALSE(experiment::flickers(moving, without));
}

TEST_CASE("noise drawn anew in every frame flickers by sqrt(2) sigma; noise that stays does not") {
  const Scene scene = shiningRoom(true);
  for (const ComponentError& error : measured("restless", scene, quickOptions()).point.errors) {
    INFO(error.output << " against " << error.reference);
    // 3 pairs of 24 x 16 x 3 values that differ by sqrt(2) sigma: one seed's RMS is known to about
    // 1/sqrt(2 x 3456) = 1.2 %, a little less well as pairs share frames; the mean of six to half a percent.
    CHECK(error.flicker.value == Approx(std::sqrt(2.0) * kSigma).epsilon(0.02));
    CHECK(error.flicker.uncertainty > 1e-3 * error.flicker.value);
    CHECK(error.flicker.uncertainty < 2e-2 * error.flicker.value);
  }
  for (const ComponentError& error : measured("patterned", scene, quickOptions()).point.errors)
    CHECK(error.flicker.value == Approx(0.0).margin(1e-6));
}

TEST_CASE("noise is told from bias, and every metric is a mean over seeds with their spread") {
  const ReportOptions options = quickOptions();
  const PointRecord record = measured("patterned", shiningRoom(false), options);
  for (const ComponentError& error : record.point.errors) {
    INFO(error.output << " against " << error.reference);
    CHECK(error.parts.noise.value == Approx(kSigma).epsilon(0.05));
    CHECK(std::abs(error.parts.bias.value - 0.02) <= 3.0 * error.parts.bias.uncertainty);
    CHECK(error.parts.bias.uncertainty < 0.01);
    CHECK_FALSE(error.deterministic);
    CHECK(error.seeds == options.seeds);
    CHECK(error.enoughSeeds());
    // The reference is 1 everywhere and has no noise. An image's mean is 1.02 with the standard deviation
    // sigma / sqrt(24 x 16 x 3), the mean over six of them is known to that / sqrt(6), and its estimate from
    // six to a factor of 1.6 either way (chi-squared with five degrees of freedom, 95 %: 0.41 to 1.6).
    const double deviation = kSigma / std::sqrt(24.0 * 16.0 * 3.0 * options.seeds);
    CHECK(std::abs(error.error.meanRatio.value - 1.02) < 4.0 * deviation);
    CHECK(error.error.meanRatio.uncertainty > 0.3 * deviation);
    CHECK(error.error.meanRatio.uncertainty < 1.8 * deviation);
    // Noise and bias together: sqrt(0.05^2 + 0.02^2).
    CHECK(error.error.rmse.value == Approx(std::hypot(kSigma, 0.02f)).epsilon(0.02));
    const std::set<std::string> spread{"rmse", "relative_mse", "bias",    "percentile95",
                                       "ssim", "flip",         "flip_ldr"};
    for (const NamedMetric& one : metricsOf(error)) {
      if (!spread.contains(one.name)) continue;
      INFO(one.name);
      CHECK(one.measured.uncertainty > 0.0);
      CHECK(one.measured.uncertainty < 0.1 * std::abs(one.measured.value - (one.name == "ssim" ? 1.0 : 0.0)));
    }
  }
  // Two seeds with noise are too few for any claim; without random numbers they are enough.
  ReportOptions two = options;
  two.seeds = 2;
  for (const ComponentError& error : measured("patterned", shiningRoom(false), two).point.errors) {
    CHECK_FALSE(error.enoughSeeds());
    for (const NamedMetric& one : metricsOf(error))
      if (one.name == "flip") CHECK_FALSE(one.measured.enoughRepeats);
  }
  for (const ComponentError& error : measured("still", shiningRoom(false), two).point.errors) {
    CHECK(error.enoughSeeds());
    CHECK(error.deterministic);
    CHECK(error.parts.noise.value == 0.0);
    CHECK(error.parts.bias.value == Approx(0.0).margin(1e-6));
  }
}

TEST_CASE("slopes are found per pipeline and parameter, with the others fixed, for errors, noise and time") {
  std::vector<ReportPoint> measuredPoints;
  for (const double cones : {4.0, 8.0})
    for (const double resolution : {16.0, 32.0, 64.0, 128.0}) {
      PointRecord record;
      record.point.pipeline = "toy.pipeline";
      record.point.parameters["resolution"].number = resolution;
      record.point.parameters["cones"].number = cones;
      ComponentError error;
      error.output = "indirect";
      error.error.noiseFloor = 0.01;
      const double rmse = 8.0 / cones / resolution;
      error.error.rmse.value = std::hypot(rmse, error.error.noiseFloor);
      error.parts.noise.value = 1.0 / std::sqrt(resolution);
      record.point.errors = {error};
      record.point.frameMs = statisticsOf({0.001 * resolution * resolution});
      measuredPoints.push_back(record.point);
    }
  std::vector<const ReportPoint*> points;
  for (const ReportPoint& point : measuredPoints) points.push_back(&point);
  const std::vector<SweepSlope> slopes = slopesOf(points);
  REQUIRE(slopes.size() == 6);  // the two cones are too few for a slope over cones
  for (const SweepSlope& slope : slopes) {
    INFO(slope.quantity << ", " << slope.others);
    CHECK(slope.parameter == "resolution");
    CHECK((slope.low == 16.0 && slope.high == 128.0));
    CHECK(slope.law.slope.value == Approx(slope.quantity == "bias"    ? -1.0
                                          : slope.quantity == "noise" ? -0.5
                                                                      : 2.0)
                                       .epsilon(1e-6));
    CHECK_FALSE(slope.law.hasPlateau());
  }
  const auto json = toJson(slopes);
  CHECK(json.at(0).at("slope").at("value").get<double>() == Approx(slopes[0].law.slope.value));
  CHECK(slopesOf({}).empty());
}

TEST_CASE("cones through random points have noise, less with more points; direct light none") {
  const Scene scene = litRoom(24, 24);
  ReportOptions options = quickOptions();
  options.seeds = 4;
  options.subpixels = 1;
  ReferenceOptions referenceOptions = quietly(16);
  experiment::SceneReference reference(scene, referenceOptions);
  const auto noiseWith = [&](int points) {
    const Pipeline pipeline = Pipeline::parse(
        "pipeline \"Points\" {\n"
        "  pass gbuffer direct_lighting.gbuffer { }\n"
        "  pass shadow direct_lighting.shadow_map { size 64 }\n"
        "  pass direct direct_lighting.shade { gbuffer gbuffer  shadow shadow.depth }\n"
        "  pass voxels voxelization.points { resolution 16  points " +
            std::to_string(points) +
            " }\n"
            "  pass light voxel_cone_tracing.inject { fragments voxels.fragments  shadow shadow.depth }\n"
            "  pass grid voxel_cone_tracing.filter { radiance light.radiance }\n"
            "  pass gather voxel_cone_tracing.gather { gbuffer gbuffer  grid grid.mips }\n"
            "  output direct direct.radiance\n  output indirect_diffuse gather.diffuse\n}\n",
        "points.pipeline");
    const experiment::MeasureContext context{{device(), techniques(), scene, options, 24, 24}, reference};
    PointRecord record;
    experiment::measureErrors(context, pipeline, record);
    double noise = 0.0;
    for (const ComponentError& error : record.point.errors) {
      INFO(error.output << " against " << error.reference);
      if (error.output == "direct") CHECK((error.deterministic && error.parts.noise.value == 0.0));
      if (error.output == "indirect_diffuse" && error.bias) {
        CHECK(error.parts.noise.value > error.parts.noise.uncertainty);
        noise = error.parts.noise.value;
      }
    }
    return noise;
  };
  const double few = noiseWith(8), many = noiseWith(512);
  INFO(few << ", " << many);
  CHECK(few > 1.5 * many);
  // 64 times as many points: strata shrink errors in proportion at the most, and independent points by 8.
  CHECK(many > few / 64.0);
}
