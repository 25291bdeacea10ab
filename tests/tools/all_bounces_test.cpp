// All bounces over frames: one law for every pipeline that reflects the light of the frame before.
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "support/scene_builder.h"
#include "support/techniques.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

constexpr double kIntensity = 3.0, kArea = 24.0, kRate = 24.0;

/// A closed box of 2 m and one albedo, with a lamp in its middle that is lit before frame `out`. From there a
/// view of 90 degrees sees one wall, equal areas in equal pixels, and all walls are alike: the image's mean
/// is that over the box.
Scene boxWithLamp(float albedo, int out) {
  SceneBuilder builder;
  builder.box({-1, -1, -1}, {1, 1, 1}, builder.lambert(albedo), true);
  LightKey dark;
  dark.time = (out - 0.5) / kRate;
  dark.power = glm::vec3(0.0f);
  builder.light(LightKind::point, glm::vec3(static_cast<float>(kIntensity)), {0, 0, 0}).motion =
      LightMotion{std::nullopt, {dark}, Interpolation::step};
  builder.look({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 0.5 * kPi, 16, 16);
  return builder.scene;
}

/// Mean indirect light of so many frames in a row, the lamp out from frame `out` on.
std::vector<double> framesOf(const std::string& name, float albedo, int frames, int out = 1 << 20) {
  RenderOptions options;
  options.accumulate = true;
  options.wanted = {"indirect_diffuse"};
  const Pipeline text = pipeline(name);
  const std::map<std::string, double> small{
      {"resolution", 32}, {"elements", 1024}, {"points", 1024}, {"lights", 1024}, {"reflected", 1024}};
  for (const PipelineParameter& parameter : text.parameters)
    if (const auto value = small.find(parameter.name); value != small.end())
      options.parameters[parameter.name].number = value->second;
  const Scene scene = boxWithLamp(albedo, out);
  PipelineExecutor executor(device(), techniques(), scene, text, options);
  std::vector<double> means;
  for (int frame = 0; frame < frames; ++frame) {
    const FrameResult result = executor.render(frame / kRate, frame);
    const std::vector<float>& values = result.outputs.at("indirect_diffuse").values();
    means.push_back(std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size()));
  }
  return means;
}

/// A pipeline, and what it keeps of the light in the box: of the first bounce and of each further one, at
/// least; the rest leaks, or is lost at edges.
struct Row {
  std::string pipeline;
  double first, further;
  int lag = 0;    ///< frames that a filter behind it, of weight 1 / 4, lags by
  int turns = 1;  ///< frames in which light is renewed once, or that which no pixel reads
};
const std::vector<Row> kRows = {{"implicit_visibility_all_bounces", 0.99, 0.99},
                                {"virtual_area_lights_all_bounces", 0.94, 0.95},
                                {"near_field_voxels_all_bounces", 0.98, 0.98, 3, 4},
                                {"voxel_cone_tracing_directional_all_bounces", 0.99, 0.97, 0, 8},
                                {"voxel_cone_tracing_clipmap_all_bounces", 0.99, 0.96, 0, 8},
                                {"imperfect_volumes_all_bounces", 0.99, 0.98, 0, 8}};

/// Of a lamp's light that is reflected twice, W/(sr m^2); all: over 1 - a.
double firstBounce(double albedo) {
  return 4.0 * kIntensity / kArea * albedo * albedo;
}

/// Frames after which less than `share` of the light of a lamp that went out is left, or of that of a lamp
/// that went on is missing. A surface reflects light that is 1 to `turns` frames old, each age as often as
/// the others: light(t) = albedo * mean of light(t - 1) to light(t - turns). With one
/// turn that is log share / log albedo.
int framesUntil(double share, double albedo, int turns) {
  std::vector<double> light(static_cast<std::size_t>(turns), 1.0);
  int frames = 0;
  while (light.back() >= share) {
    light.push_back(albedo * std::accumulate(light.end() - turns, light.end(), 0.0) / turns);
    ++frames;
  }
  return frames;
}
/// Frames after which less than a thousandth is missing.
int enough(double albedo, int turns) {
  return framesUntil(0.001, albedo, turns);
}

/// What each further bounce keeps where the first brings `first` and all together bring `all`:
/// all = first / (1 - albedo kept).
double kept(double albedo, double first, double all) {
  return (1.0 - first / all) / albedo;
}

}  // namespace

TEST_CASE(
    "in a closed box of albedo 0.5 frames in a row come to L / (1 - a), but for what each bounce leaks") {
  const Row& row = kRows.at(GENERATE(0, 1, 2, 3, 4, 5));
  const std::vector<double> mean = framesOf(row.pipeline, 0.5f, enough(0.5, row.turns) + row.lag);
  const double first = mean.front() / firstBounce(0.5), further = kept(0.5, mean.front(), mean.back());
  CAPTURE(row.pipeline, first, further);
  CHECK(first > row.first);
  CHECK(first < 1.02);
  CHECK(further > row.further);
  CHECK(further < 1.01);
  // The second frame has one bounce more, and none counts twice.
  if (row.lag == 0) CHECK(mean[1] / mean[0] == Approx(1.0 + 0.5 * further).epsilon(0.02));
}

TEST_CASE(
    "light of a lamp that goes out is gone to 1 % within log 0.01 / log albedo frames, and more where it is renewed in turns") {
  const Row& row = kRows.at(GENERATE(0, 1, 2, 3, 4, 5));
  const int out = framesUntil(0.005, 0.5, row.turns), frames = framesUntil(0.01, 0.5, row.turns) + row.lag;
  const std::vector<double> mean = framesOf(row.pipeline, 0.5f, out + frames + 1, out);
  CAPTURE(row.pipeline, mean[out - 1], mean[out], mean[out + frames]);
  CHECK(mean[out] > 0.2 * mean[out - 1]);  // what arrived before is reflected once more
  // The first frame without the lamp still reflects all: half of the light from before at this albedo.
  CHECK(mean[out + framesUntil(0.2525, 0.5, row.turns) - 1 + row.lag] < 0.505 * mean[out]);
  CHECK(mean[out + frames] < 0.01 * mean[out - 1]);
}

TEST_CASE("what moves reads no light that was left out in the frame before") {
  const Row& row = kRows.at(GENERATE(0, 1, 2, 3, 4, 5));
  RenderOptions options;
  options.accumulate = options.checkReads = true;
  options.width = options.height = 24;
  const Pipeline text = pipeline(row.pipeline);
  for (const PipelineParameter& parameter : text.parameters)
    if (parameter.name == "resolution" || parameter.name == "rays")
      options.parameters[parameter.name].number = 16;
  const Scene scene = loadScene(sourceDirectory() / "scenes/spinning_box.scene");
  PipelineExecutor executor(device(), techniques(), scene, text, options);
  for (int frame = 0; frame < 3 + row.turns; ++frame) {
    CAPTURE(row.pipeline, frame);
    CHECK(executor.render(0.25 * frame, frame).readsFindings == std::vector<std::string>{});
  }
}

// A minute of frames for each pipeline, five where light is renewed in turns.
TEST_CASE(
    "in closed boxes of albedo 0.9 and 0.99 each bounce keeps what it keeps at 0.5, and without leaks all is there",
    "[.]") {
  const Row& row = kRows.at(GENERATE(0, 1, 2, 3, 4, 5));
  const std::vector<double> half = framesOf(row.pipeline, 0.5f, enough(0.5, row.turns) + 5 * row.lag);
  const double further = kept(0.5, half.front(), half.back());
  for (const float albedo : {0.9f, 0.99f}) {
    const std::vector<double> mean =
        framesOf(row.pipeline, albedo, enough(albedo * std::min(further, 1.0), row.turns) + 5 * row.lag);
    const double all = mean.back() / (firstBounce(albedo) / (1.0 - albedo)),
                 here = kept(albedo, mean.front(), mean.back());
    CAPTURE(row.pipeline, albedo, further, all, here);
    CHECK(here == Approx(further).margin(0.02));
    if (row.first > 0.99 && row.further > 0.98) CHECK(all == Approx(1.0).epsilon(0.02));
  }
}
