// Light of near field voxels with few rays, filtered over frames: what is left of its noise, and how far it
// lags.
#include <cmath>

#include "support/kept_table.h"
#include "support/passes.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

constexpr int kSize = 64;
constexpr double kRate = 24.0;  // frames/s

/// The committed pipeline, or the same without its filters.
Pipeline textOf(bool filtered, const std::string& form = "") {
  const Pipeline committed = pipeline("near_field_voxels_filtered");
  std::string text = committed.document->source;
  const auto replace = [&](const std::string& from, const std::string& to, const std::string& by) {
    const std::size_t first = text.find(from), end = text.find(to, first);
    REQUIRE(end != std::string::npos);
    text.replace(first, end - first, by);
  };
  if (!filtered) {
    replace("  pass accumulate ", "  pass compose ",
            "  pass atrous image_filters.smooth { gbuffer gbuffer  diffuse gather.arriving  radius 0 }\n");
  } else if (!form.empty()) {
    replace("    diffuse gather.arriving", "\n", "    diffuse gather.arriving\n    " + form);
    replace("    diffuse accumulate.diffuse", "\n", "    diffuse accumulate.diffuse\n    " + form);
  }
  return Pipeline::parse(text, committed.file);
}

/// Indirect light of the frames of a run, `step` s apart.
std::vector<ImageBuffer> framesOf(const Scene& scene, const Pipeline& text, int rays, int frames,
                                  double step) {
  RenderOptions options = sized(kSize, kSize);
  options.parameters = text.settings({"rays=" + std::to_string(rays)});
  options.accumulate = true;
  PipelineExecutor executor(device(), techniques(), scene, text, options);
  std::vector<ImageBuffer> result;
  for (int frame = 0; frame < frames; ++frame)
    result.push_back(executor.render(frame * step, frame).outputs.at("indirect_diffuse"));
  return result;
}

/// The gather's own truth at a time: its bias is that of voxels and no filter's matter.
ImageBuffer truthAt(const Scene& scene, double time, int rays) {
  const Pipeline text = textOf(false);
  RenderOptions options = sized(kSize, kSize);
  options.parameters = text.settings({"rays=" + std::to_string(rays)});
  PipelineExecutor executor(device(), techniques(), scene, text, options);
  return executor.render(time, 1).outputs.at("indirect_diffuse");
}

double ratioOf(const ImageBuffer& image, const ImageBuffer& truth) {
  return meanOf(image) / meanOf(truth);
}

/// RMS of the change between two frames that the truth does not make.
double flickerOf(const std::vector<ImageBuffer>& frames, const ImageBuffer& before, const ImageBuffer& after,
                 std::size_t last) {
  double squares = 0.0;
  const std::size_t count = after.values().size();
  for (std::size_t i = 0; i < count; ++i) {
    const double own = static_cast<double>(frames[last].values()[i]) -
                       static_cast<double>(frames[last - 1].values()[i]),
                 right = static_cast<double>(after.values()[i]) - static_cast<double>(before.values()[i]);
    squares += (own - right) * (own - right);
  }
  return std::sqrt(squares / static_cast<double>(count));
}

/// A still scene before a camera that moves sideways by a length in each frame.
Scene seenInPassing(const std::string& name, const glm::dvec3& metresAFrame) {
  Scene scene = committed(name);
  scene.cameras.front().motion = RigidMotion{{0, 1, 0}, 0.0, {0, 0, 0}, metresAFrame * kRate};
  return scene;
}

}  // namespace

TEST_CASE(
    "sixteen filtered frames of a still room err by less than half of a gather of four times the rays") {
  const Scene scene = committed("cornell");
  const ImageBuffer truth = truthAt(scene, 0.0, 1024);
  const double more = rmsBetween(truthAt(scene, 0.0, 32), truth);
  const std::vector<ImageBuffer> filtered = framesOf(scene, textOf(true), 8, 16, 0.0);
  CAPTURE(more, rmsBetween(filtered.back(), truth));
  CHECK(rmsBetween(filtered.back(), truth) < 0.5 * more);
  CHECK(ratioOf(filtered.back(), truth) == Approx(1.0).margin(0.03));
}

TEST_CASE("table: errors of light filtered over frames of still scenes", "[.]") {
  // On the last two scenes nothing was tuned.
  KeptTable table("image_filters.still", {{"8 rays", 4, 0.0005, 0.05},
                                          {"32 rays", 4, 0.0005, 0.05},
                                          {"one frame", 4, 0.0005, 0.05},
                                          {"16 frames", 4, 0.0005, 0.05},
                                          {"light of these", 2, 0.01}});
  for (const char* name : {"cornell", "cornell_glossy", "corridor", "arcade", "spinning_box", "sibenik",
                           "untuned/room", "untuned/court"}) {
    const Scene scene = committed(name);
    const ImageBuffer truth = truthAt(scene, 0.0, 2048);
    const std::vector<ImageBuffer> filtered = framesOf(scene, textOf(true), 8, 16, 0.0);
    const double few = rmsBetween(truthAt(scene, 0.0, 8), truth),
                 more = rmsBetween(truthAt(scene, 0.0, 32), truth),
                 alone = rmsBetween(filtered.front(), truth), many = rmsBetween(filtered.back(), truth),
                 ratio = ratioOf(filtered.back(), truth);
    table.row(name, {few, more, alone, many, ratio});
    CAPTURE(name);
    CHECK(alone < few);
    CHECK(many < 0.5 * more);
    CHECK(many < alone);
    CHECK(ratio == Approx(1.0).margin(0.11));
  }
}

TEST_CASE("table: errors, lag and flicker of light filtered over frames that move", "[.]") {
  KeptTable table("image_filters.moving", {{"8 rays", 4, 0.0005, 0.05},
                                           {"filtered", 4, 0.0005, 0.05},
                                           {"ratio", 2, 0.01},
                                           {"as published", 4, 0.0005, 0.05},
                                           {"ratio as published", 2, 0.01}});
  KeptTable flicker(
      "image_filters.flicker",
      {{"8 rays", 4, 0.0005, 0.05}, {"filtered", 4, 0.0005, 0.05}, {"as published", 4, 0.0005, 0.05}});
  struct Row {
    const char* name;
    Scene scene;
    std::vector<int> frames;
  };
  constexpr int kRays = 1024;
  for (const Row& row : {Row{"moving_sun", committed("moving_sun"), {12}},
                         Row{"spinning_box", committed("spinning_box"), {12}},
                         Row{"cornell in passing", seenInPassing("cornell", {0.004, 0, 0}), {12}},
                         Row{"arcade in passing", seenInPassing("arcade", {0.05, 0, 0}), {12}},
                         Row{"switched_lamp", committed("switched_lamp"), {2, 3, 5, 12}}}) {
    const std::vector<ImageBuffer> plain = framesOf(row.scene, textOf(false), 8, 13, 1.0 / kRate),
                                   ours = framesOf(row.scene, textOf(true), 8, 13, 1.0 / kRate),
                                   printed = framesOf(row.scene, textOf(true, "as_published on"), 8, 13,
                                                      1.0 / kRate);
    for (const int frame : row.frames) {
      const ImageBuffer truth = truthAt(row.scene, frame / kRate, kRays);
      const auto at = static_cast<std::size_t>(frame);
      const double noisy = rmsBetween(plain[at], truth), own = rmsBetween(ours[at], truth),
                   published = rmsBetween(printed[at], truth);
      table.row(fmt::format("{}, frame {}", row.name, frame),
                {noisy, own, ratioOf(ours[at], truth), published, ratioOf(printed[at], truth)});
      CAPTURE(row.name, frame);
      CHECK(own < noisy);
      // Under a moving sun a fixed weight follows the light sooner.
      CHECK(own < (std::string(row.name) == "moving_sun" ? 1.15 : 1.05) * published);
      // A lamp that has gone out stays longer in a history of fixed weight.
      if (std::string(row.name) == "switched_lamp" && frame > 2)
        CHECK(ratioOf(ours[at], truth) < ratioOf(printed[at], truth));
    }
    const ImageBuffer before = truthAt(row.scene, 11 / kRate, kRays),
                      after = truthAt(row.scene, 12 / kRate, kRays);
    const double noisy = flickerOf(plain, before, after, 12), own = flickerOf(ours, before, after, 12),
                 published = flickerOf(printed, before, after, 12);
    flicker.row(row.name, {noisy, own, published});
    CAPTURE(row.name);
    CHECK(own < 0.5 * noisy);
    CHECK(published < 0.5 * noisy);
  }
}
