// The report's decisions that need no device: references, whole images, sizes, uncertainties, places.
#include <cmath>

#include "lumivox/base/error.h"
#include "lumivox/experiment/report.h"
#include "lumivox/pipeline/pass.h"
#include "lumivox/results/text.h"
#include "support/facts.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

ImageBuffer constant(float value) {
  return ImageBuffer(2, 2, 3, value);
}

LayeredImage reference() {
  LayeredImage image;
  float value = 1.0f;
  for (const char* name :
       {"direct", "one_bounce_diffuse", "one_bounce_glossy", "indirect_diffuse", "indirect_glossy", "full"}) {
    image.layers[name] = constant(value);
    image.layers[std::string(name) + ".variance"] = constant(0.01f * value);
    value *= 2.0f;
  }
  return image;
}

/// A pass whose one output needs a glossy material, and one that needs nothing.
struct Shine : Pass {
  Out<Image> glossy{this, "glossy", Contributes::indirectGlossy, Needs::glossyMaterial};
  void run(PassContext&) override {}
};
struct Plain : Pass {
  Out<Image> radiance{this, "radiance", Contributes::direct};
  void run(PassContext&) override {}
};
/// Its image comes from a required input.
struct Blur : Pass {
  In<Image> source{this, "source"};
  Out<Image> blurred{this, "blurred", Contributes::indirectDiffuse};
  void run(PassContext&) override {}
};

struct Toys : TechniqueSource {
  Toys() {
    technique_.name = "toys";
    technique_.passes = {{"shine", "", [] { return std::make_unique<Shine>(); }},
                         {"plain", "", [] { return std::make_unique<Plain>(); }},
                         {"blur", "", [] { return std::make_unique<Blur>(); }}};
  }
  const Technique* technique(const std::string& name) override {
    return name == "toys" ? &technique_ : nullptr;
  }
  std::vector<std::string> available() const override { return {"toys"}; }
  const std::vector<SkippedTechnique>& skipped() const override { return skipped_; }

 private:
  Technique technique_;
  std::vector<SkippedTechnique> skipped_;
};

}  // namespace

TEST_CASE("a component is judged by its own bounce for bias and by full transport for what it misses") {
  CHECK(referenceLayers(Contributes::direct) == std::pair<std::string, std::string>("direct", "direct"));
  CHECK(referenceLayers(Contributes::indirectDiffuse) ==
        std::pair<std::string, std::string>("one_bounce_diffuse", "indirect_diffuse"));
  CHECK(referenceLayers(Contributes::final) == std::pair<std::string, std::string>("one_bounce", "full"));
  CHECK(referenceLayers(Contributes::nothing).first.empty());
}

TEST_CASE("the one-bounce image is direct light and both first bounces, and their variances add") {
  const auto layer = referenceLayer(reference(), "one_bounce");
  REQUIRE(layer);
  CHECK(layer->mean.at(1, 1, 2) == 1.0f + 2.0f + 4.0f);
  CHECK(layer->variance.at(0, 1, 0) == Approx(0.07));
  CHECK(referenceLayer(reference(), "full")->mean.at(0, 0, 0) == 32.0f);
  CHECK_FALSE(referenceLayer(reference(), "scattered"));
  LayeredImage lacking = reference();
  lacking.layers.erase("one_bounce_glossy");
  CHECK_FALSE(referenceLayer(lacking, "one_bounce"));
}

TEST_CASE("the whole image is the output called final, else the sum of what is radiance") {
  FrameResult frame;
  frame.outputs["direct"] = constant(1.0f);
  frame.outputs["bounce"] = constant(0.5f);
  frame.outputs["occlusion"] = ImageBuffer(2, 2, 1, 0.25f);
  frame.components = {{"direct", Contributes::direct},
                      {"bounce", Contributes::indirectDiffuse},
                      {"occlusion", Contributes::ambientOcclusion}};
  CHECK(compositeImage(frame).at(0, 1, 1) == 1.5f);
  frame.outputs["composed"] = constant(7.0f);
  frame.components["composed"] = Contributes::final;
  CHECK(compositeImage(frame).at(0, 1, 1) == 7.0f);
  CHECK(compositeImage(FrameResult{}).empty());
}

TEST_CASE("an error is told as its share of leaving the light out, where there is light") {
  ComponentError error;
  error.error.rmse = {0.5, 0.04};
  error.errorOfNothing.rmse = {2.0, 0.0};
  CHECK(error.ratioToNothing() == Approx(0.25));
  error.errorOfNothing.rmse = {0.0, 0.0};
  CHECK(std::isnan(error.ratioToNothing()));
}

TEST_CASE("an image is reduced to its limit with its aspect kept, and never enlarged") {
  CHECK(reducedResolution(256, 256, 128) == std::pair(128, 128));
  CHECK(reducedResolution(1920, 1080, 160) == std::pair(160, 90));
  CHECK(reducedResolution(100, 50, 160) == std::pair(100, 50));
  CHECK(reducedResolution(10000, 1, 100) == std::pair(100, 1));
}

TEST_CASE("numbers have three digits, times of 100 ms are whole, no share is minus zero") {
  CHECK(formatMilliseconds(1548.3) == "1548");
  CHECK(formatMilliseconds(4.5612) == "4.56");
  CHECK(formatMilliseconds(0.01234) == "0.0123");
  CHECK(formatPercent(-0.001) == "0 %");
  CHECK(formatPercent(0.416) == "42 %");
}

TEST_CASE("the reference takes fewer samples per pixel the larger the image, within bounds") {
  CHECK(referenceSamplesFor(64, 64) > referenceSamplesFor(128, 128));
  CHECK(referenceSamplesFor(1, 1) <= 4096);
  CHECK(referenceSamplesFor(16384, 16384) >= 64);
}

TEST_CASE("a pipeline suits unless all that it adds to direct light needs what the scene lacks") {
  const auto [passes, suitsDiffuse] = GENERATE(table<const char*, bool>({
      {"pass d toys.plain { }\npass s toys.shine { }\noutput direct d.radiance\noutput glossy s.glossy",
       false},
      {"pass d toys.plain { }\noutput direct d.radiance", true},
      {"pass s toys.shine { }\npass b toys.blur { source s.glossy }\noutput indirect_diffuse b.blurred",
       false},
  }));
  SceneTraits diffuse;
  diffuse.triangles = true;
  SceneTraits shiny = diffuse;
  shiny.glossy = true;
  Toys toys;
  const Pipeline pipeline =
      Pipeline::parse(std::string("pipeline \"A\" {\n") + passes + "\n}\n", "toys.pipeline");
  CHECK(whyUnsuited(pipeline, toys, shiny).empty());
  const std::string why = whyUnsuited(pipeline, toys, diffuse);
  CHECK(why.empty() == suitsDiffuse);
  if (!suitsDiffuse) CHECK_THAT(why, Tells("glossy"));
}

TEST_CASE("the committed scenes are found from any folder inside the project") {
  const auto found = committedScenes(sourceDirectory() / "scenes" / "pipelines");
  REQUIRE(found);
  CHECK(std::filesystem::equivalent(*found, sourceDirectory() / "scenes"));
  const auto pipelines = pipelinesIn(*found / "pipelines");
  CHECK(pipelines.size() >= 2);
  CHECK(std::is_sorted(pipelines.begin(), pipelines.end()));
}
