// Committed scenes against the path tracer.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "support/against_reference.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

Scene committed(const std::string& name) {
  return loadScene(sourceDirectory() / ("scenes/" + name + ".scene"));
}

struct Errors {
  Against diffuse, glossy, occlusion;
  double openness;  ///< RMS difference of ambient occlusion, of 1
};

/// Of ambient occlusion, without the reference's noise.
double opennessError(const LayeredImage& reference, const ImageBuffer& image) {
  const ImageError error = compare(image, reference.layers.at("ambient_occlusion"),
                                   reference.layers.at("ambient_occlusion.variance"));
  return std::sqrt(std::max(0.0, error.rmse.value * error.rmse.value - error.noiseFloor * error.noiseFloor));
}

Errors errorsOn(const std::string& name, const std::vector<std::string>& settings,
                const Picture& picture = {96, 96, 128}) {
  const Scene scene = committed(name);
  const LayeredImage reference = referenceOf(scene, picture);
  const FrameResult frame = pictured(scene, picture, pipeline("implicit_visibility"), settings);
  return {lightAgainst(reference, frame.outputs.at("indirect_diffuse")),
          against(reference, frame.outputs.at("indirect_glossy"), "one_bounce_glossy", 0.0f),
          occlusionAgainst(reference, frame.outputs.at("ambient_occlusion")),
          opennessError(reference, frame.outputs.at("ambient_occlusion"))};
}

}  // namespace

TEST_CASE(
    "the Cornell box has at most 0.15 of the error of no indirect light, with 0.93 to 1.07 of its energy") {
  const Errors errors = errorsOn("cornell", {}, {64, 64, 128});
  CAPTURE(errors.diffuse.rmse, errors.diffuse.ratio);
  CHECK(errors.diffuse.rmse <= 0.15);
  CHECK(errors.diffuse.ratio == Approx(1.0).margin(0.07));
  CAPTURE(errors.openness);
  CHECK(errors.openness <= 0.06);
}

TEST_CASE("eight bounces in the Cornell box are full indirect light within 0.15 of its error") {
  const Picture picture{64, 64, 128};
  const Scene scene = committed("cornell");
  ReferenceOptions options = quietly(picture.referenceSamples, 32);
  options.width = picture.width, options.height = picture.height;
  options.useCache = true;
  const LayeredImage reference = cachedReference(scene, options);
  const FrameResult frame = pictured(scene, picture, pipeline("implicit_visibility"), {"bounces=8"});
  const Against error = against(reference, frame.outputs.at("indirect_diffuse"), "indirect_diffuse", 0.0f);
  CAPTURE(error.rmse, error.ratio);
  CHECK(error.rmse <= 0.15);
}

TEST_CASE("the arcade has at most 0.45 of the error of no indirect light") {
  const Errors errors = errorsOn("arcade", {}, {64, 64, 128});
  CAPTURE(errors.diffuse.rmse, errors.diffuse.ratio);
  CHECK(errors.diffuse.rmse <= 0.45);
  CHECK(errors.diffuse.ratio >= 0.7);
  CHECK(errors.diffuse.ratio <= 0.9);
}

TEST_CASE("in the corridor, where all light comes around a corner, the error is at most 0.5 of no light") {
  const Errors errors = errorsOn("corridor", {}, {96, 96, 128});
  CAPTURE(errors.diffuse.rmse, errors.diffuse.ratio);
  CHECK(errors.diffuse.rmse <= 0.5);
  CHECK(errors.diffuse.ratio == Approx(1.0).margin(0.2));
}

TEST_CASE("the spinning box has at most 0.3 of the error of no indirect light") {
  const Errors errors = errorsOn("spinning_box", {}, {64, 64, 128});
  CAPTURE(errors.diffuse.rmse, errors.diffuse.ratio);
  CHECK(errors.diffuse.rmse <= 0.3);
  CHECK(errors.diffuse.ratio == Approx(1.0).margin(0.15));
}

TEST_CASE("glossy surfaces of the Cornell box have at most 0.4 of the error of no glossy light") {
  const Errors errors = errorsOn("cornell_glossy", {}, {64, 64, 128});
  CAPTURE(errors.glossy.rmse, errors.glossy.ratio);
  CHECK(errors.glossy.rmse <= 0.4);
  CHECK(errors.glossy.ratio == Approx(1.0).margin(0.2));
}

TEST_CASE("the printed words, each alone and all together, cost what the card says", "[.]") {
  struct Words {
    const char* name;
    std::vector<std::string> settings;
  };
  const std::string element = "weight=element", one = "fill=one", kept = "push=kept";
  for (const char* elements : {"elements=1024", "elements=4096"})
    for (const Words& words : {Words{"ours", {}}, Words{"weight", {element}}, Words{"fill", {one}},
                               Words{"push", {kept}}, Words{"all", {element, one, kept}}}) {
      std::vector<std::string> settings = words.settings;
      settings.push_back(elements);
      const Errors errors = errorsOn("cornell", settings, {64, 64, 128});
      std::printf("%s %-7s diffuse %.3f ratio %.3f\n", elements, words.name, errors.diffuse.rmse,
                  errors.diffuse.ratio);
      std::fflush(stdout);
      if (words.settings.empty())
        CHECK(errors.diffuse.rmse < 0.12);
      else
        CHECK(errors.diffuse.rmse > 0.05);
    }
}

TEST_CASE("table: errors of indirect light by elements and bins", "[.]") {
  for (const char* name : {"cornell", "arcade", "corridor", "spinning_box", "cornell_glossy"})
    for (const char* elements : {"elements=1024", "elements=4096", "elements=16384"})
      for (const char* bins : {"bins=8", "bins=12", "bins=16"}) {
        if (std::string(elements) == "elements=16384" && std::string(bins) == "bins=16")
          continue;  // the device's buffers
        const Errors errors = errorsOn(name, {elements, bins});
        std::printf(
            "%-15s %-15s %-8s diffuse %.3f ratio %.3f  glossy %.3f ratio %.3f  occlusion %.3f absolute %.3f\n",
            name, elements, bins, errors.diffuse.rmse, errors.diffuse.ratio, errors.glossy.rmse,
            errors.glossy.ratio, errors.occlusion.rmse, errors.openness);
        std::fflush(stdout);
        CHECK(errors.diffuse.rmse < 0.9);
      }
}

TEST_CASE("table: errors of ambient occlusion by scene, elements and bins", "[.]") {
  const Picture picture{64, 64, 128};
  const auto text = pipeline("implicit_visibility");
  for (const char* name : {"cornell", "corridor", "spinning_box", "chess", "teapot_sky", "vase", "arcade"}) {
    const Scene scene = committed(name);
    const LayeredImage reference = referenceOf(scene, picture);
    for (const char* elements : {"elements=4096", "elements=16384"})
      for (const char* bins : {"bins=8", "bins=16"}) {
        if (std::string(elements) == "elements=16384" && std::string(bins) == "bins=16") continue;
        const FrameResult frame = pictured(scene, picture, text, {elements, bins});
        const ImageBuffer& openness = frame.outputs.at("ambient_occlusion");
        std::printf("%-15s %-15s %-8s RMS %.3f mean ratio %.3f\n", name, elements, bins,
                    opennessError(reference, openness), occlusionAgainst(reference, openness).ratio);
        std::fflush(stdout);
        CHECK(opennessError(reference, openness) < 0.3);
      }
  }
}
