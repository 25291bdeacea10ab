// Captured frames on the committed mixed-reality scenes, against the path-traced truth of the merged scenes.
#include <cmath>

#include "lumivox/base/file.h"
#include "support/against_reference.h"
#include "support/captured_scenes.h"
#include "support/captures.h"
#include "support/kept_table.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

const Picture kSmall{80, 60, 128};

Pipeline captured(const std::string& name = "") {
  return pipeline(name.empty() ? "captured_frames" : "captured_frames/captured_frames_" + name);
}

/// Indirect light of virtual surfaces over leaving the captured light out; real pixels are black in both.
Against errorOf(const Scene& scene, const Picture& picture, const Pipeline& text,
                const std::vector<std::string>& settings = {}, const std::string& lobe = "diffuse") {
  return against(truthOf(scene, picture),
                 pictured(scene, picture, text, settings).outputs.at("indirect_" + lobe), "indirect_" + lobe,
                 0.0f);
}

}  // namespace

TEST_CASE("one noisy picture lights virtual content better than none, with its energy") {
  const Against found = errorOf(committed("mixed_reality"), kSmall, captured());
  INFO("RMSE over none " << found.rmse << ", mean " << found.ratio);
  CHECK(found.rmse < 0.7);
  CHECK(found.ratio > 0.7);
  CHECK(found.ratio < 1.2);
}

TEST_CASE("three pictures from three sides err less than one of them") {
  const Scene scene = committed("mixed_reality_three");
  const double last = scene.captures.at(0)->frames.back().time;
  const auto errorWith = [&](const char* frames) {
    RenderOptions options;
    options.width = kSmall.width, options.height = kSmall.height;
    const Pipeline text = captured();
    options.parameters = text.settings({std::string("pictures=") + frames});
    const FrameResult frame = PipelineExecutor(device(), techniques(), scene, text, options).render(last);
    return against(truthOf(scene, kSmall, last), frame.outputs.at("indirect_diffuse"), "indirect_diffuse",
                   0.0f);
  };
  const Against one = errorWith("1"), three = errorWith("3");
  INFO("one: " << one.rmse << " (" << one.ratio << "), three: " << three.rmse << " (" << three.ratio << ")");
  CHECK(three.rmse < one.rmse);
  CHECK(three.rmse < 0.5);
  CHECK(three.ratio > 0.75);
  CHECK(three.ratio < 1.2);
}

TEST_CASE("a lamp that the scene knows by the real one's name stands once in the truth") {
  const Scene scene = committed("mixed_reality");
  ReferenceOptions options = quietly(64);
  options.width = 40, options.height = 30;
  const LayeredImage merged = renderReference(scene, options);
  // Far from virtual content the picture is that of the real room.
  const Capture& capture = *scene.captures.at(0);
  const Scene alone = seenBy(capture, capture.frames.front(), *capture.realScene);
  const ImageBuffer truth = renderReference(alone, options).layers.at("full"),
                    &full = merged.layers.at("full");
  double sum = 0.0, expected = 0.0;
  for (int y = 0; y < 12; ++y)  // the upper part of the image: walls and ceiling
    for (int x = 0; x < 40; ++x)
      for (int c = 0; c < 3; ++c) {
        sum += full.at(x, y, c);
        expected += truth.at(x, y, c);
      }
  CHECK(sum == Approx(expected).epsilon(0.05));
  // Components are those of virtual surfaces alone.
  const ImageBuffer& indirect = merged.layers.at("indirect_diffuse");
  CHECK(indirect.at(20, 10, 0) == 0.0f);
  CHECK(full.at(20, 10, 0) > 0.0f);
}

TEST_CASE("captured light is judged by all bounces, and in a scene without a capture by one") {
  const auto bouncesIn = [](const Scene& scene, const RenderOptions& options) {
    return PipelineExecutor(device(), techniques(), scene, captured(), options)
        .indirectBounces()
        .at("indirect_diffuse");
  };
  RenderOptions everything;
  everything.keepEverything = true;
  for (const RenderOptions& options : {RenderOptions{}, everything}) {
    CHECK(bouncesIn(committed("mixed_reality"), options) == 32);
    CHECK(bouncesIn(committed("cornell"), options) == 1);
  }
}

// The numbers of the card; minutes.
TEST_CASE("errors of captured frames", "[.]") {
  const Picture picture{160, 120, 512};
  KeptTable table("captured_frames.errors", {{"diffuse", 3, 0.02}, {"mean", 2, 0.02}, {"glossy", 3, 0.03}});
  const auto rows = [&](const Scene& one, double time, const std::string& beginning, const auto& each) {
    const LayeredImage truth = truthOf(one, picture, time);
    each([&](const std::string& name, const Scene& scene, const Pipeline& text,
             const std::vector<std::string>& settings) {
      RenderOptions sized;
      sized.width = picture.width, sized.height = picture.height;
      sized.parameters = text.settings(settings);
      const FrameResult frame = PipelineExecutor(device(), techniques(), scene, text, sized).render(time);
      const Against diffuse = against(truth, frame.outputs.at("indirect_diffuse"), "indirect_diffuse", 0.0f);
      const Against glossy = against(truth, frame.outputs.at("indirect_glossy"), "indirect_glossy", 0.0f);
      table.row(beginning + name, {diffuse.rmse, diffuse.ratio, glossy.rmse});
    });
  };
  const std::vector<std::string> none;
  const Scene one = committed("mixed_reality"), three = committed("mixed_reality_three");
  rows(one, 0.0, "one picture", [&](const auto& row) {
    const Scene clean = withImages(one, exactImages(*one.captures.at(0), 512));
    row("", one, captured(), none);
    row(", one way", one, captured("one_way"), none);
    row(", exact", clean, captured(), {"brightest=1"});
    row(", exact, every pixel at every pixel", clean, captured("brute_force"), {"brightest=1"});
    row(", every pixel at every pixel", one, captured("brute_force"), none);
    row(", without the filter", one, captured(), {"filter=0"});
    row(", without occlusion", one, captured(), {"occlusion=off"});
    row(", as published", one, captured("as_published"), none);
  });
  rows(three, three.captures.at(0)->frames.back().time, "three sides, ", [&](const auto& row) {
    for (const char* pictures : {"1", "2", "3"})
      row(std::string(pictures) + (*pictures == '1' ? " picture" : " pictures"), three, captured(),
          {std::string("pictures=") + pictures});
  });
}
