// Closed rooms whose walls all emit E and reflect a: radiance is the same everywhere and in every direction,
// L = E + a L. Cut off after B indirect bounces it is the geometric series E (1 + a + ... + a^(B+1)) = E (1 -
// a^(B+2)) / (1 - a): emission, direct light and B bounces.
#include <algorithm>
#include <cmath>
#include <sstream>

#include "lumivox/base/error.h"
#include "lumivox/reference/path_tracer.h"
#include "support/facts.h"
#include "support/scene_builder.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

Scene furnace(float albedo, float emission, int size) {
  SceneBuilder builder;
  builder.box({0, 0, 0}, {1, 1.5f, 2}, builder.lambert(albedo, emission), true);
  builder.look({0.5, 0.7, 1.6}, {0.3, 0.4, 0}, {0, 1, 0}, 1.2, size, size);
  return builder.scene;
}

double geometricSeries(double albedo, int terms) {
  return (1.0 - std::pow(albedo, terms)) / (1.0 - albedo);
}

}  // namespace

TEST_CASE("a closed furnace of albedo a returns E / (1 - a) within 0.2 %") {
  for (const float albedo : {0.2f, 0.5f, 0.8f, 0.95f}) {
    CAPTURE(albedo);
    // The part cut off is a^(B+2) of the whole: below 1e-5 here.
    ReferenceOptions options =
        quietly(albedo < 0.9f ? 64 : 8, static_cast<int>(std::ceil(std::log(1e-5) / std::log(albedo))));
    options.roulette = false;
    const LayeredImage image = renderReference(furnace(albedo, 2.0f, 32), options);
    const Estimate full = estimateOf(image, "full");
    const double expected = 2.0 / (1.0 - albedo);
    CHECK(full.deviation < 0.0007 * expected);
    CHECK(full.mean == Approx(expected).epsilon(0.002));
    // No pixel stands out.
    const auto [lowest, highest] =
        std::minmax_element(image.layers.at("full").values().begin(), image.layers.at("full").values().end());
    CHECK(*lowest == Approx(expected).epsilon(0.2));
    CHECK(*highest == Approx(expected).epsilon(0.2));
  }
}

TEST_CASE("a furnace of albedo 0.999 converges when enough bounces are allowed") {
  // 16 x 16 paths of 10002 vertices: a relative deviation of about 1 / sqrt(2.5e6), a third of the tolerance.
  ReferenceOptions options = quietly(16, 10000);
  options.roulette = false;
  const double full = estimateOf(renderReference(furnace(0.999f, 1.0f, 4), options), "full").mean;
  CHECK(full == Approx(geometricSeries(0.999f, 10002)).epsilon(0.002));
  CHECK(full == Approx(1000.0).epsilon(0.002));
}

TEST_CASE("a reference tells how much light lies beyond its last bounce") {
  // N bounces leave a^(N+2) of a furnace's light out.
  for (const float albedo : {0.5f, 0.9f, 0.95f, 0.99f}) {
    CAPTURE(albedo);
    ReferenceOptions options = quietly(64, 32);
    options.roulette = false;
    std::istringstream told(renderReference(furnace(albedo, 1.0f, 16), options).attributes.at("cut_off"));
    double share = -1.0, radius = -1.0;
    told >> share >> radius;
    CHECK(share == Approx(std::pow(static_cast<double>(albedo), 34.0)).epsilon(0.1).margin(1e-9));
    CHECK(radius == Approx(static_cast<double>(albedo)).epsilon(0.01));
  }
  // Three bounces have no quarters to compare.
  CHECK(renderReference(furnace(0.9f, 1.0f, 8), quietly(4, 3)).attributes.at("cut_off") == "0 0");
}

TEST_CASE("Russian roulette leaves the furnace's radiance as it is") {
  ReferenceOptions options = quietly(64, 4000);
  options.roulette = true;
  const Estimate full = estimateOf(renderReference(furnace(0.95f, 1.0f, 32), options), "full");
  CHECK(full.deviation < 0.005 * full.mean);
  CHECK(std::abs(full.mean - 20.0) < 4.0 * full.deviation);
}

TEST_CASE("layers of a furnace are partial sums of its geometric series") {
  const double albedo = 0.6;
  ReferenceOptions options = quietly(64, 8);
  options.roulette = false;
  options.bounceLayers = {4, 1, 2, 4};
  const LayeredImage image = renderReference(furnace(0.6f, 1.0f, 16), options);
  const auto mean = [&](const std::string& layer) { return estimateOf(image, layer).mean; };
  CHECK(mean("direct") == Approx(1.0 + albedo).epsilon(0.002));
  CHECK(mean("one_bounce_diffuse") == Approx(albedo * albedo).epsilon(0.004));
  CHECK(mean("indirect_diffuse") == Approx(albedo * albedo * geometricSeries(albedo, 8)).epsilon(0.003));
  CHECK(mean("full") == Approx(geometricSeries(albedo, 10)).epsilon(0.002));
  for (const char* layer : {"one_bounce_glossy", "indirect_glossy"}) CHECK(mean(layer) == 0.0);
  for (const int bounces : {1, 2, 4}) {
    CAPTURE(bounces);
    const std::string layer = "bounces_" + std::to_string(bounces);
    // Emission, direct light, and N terms more.
    CHECK(mean(layer) == Approx(geometricSeries(albedo, bounces + 2)).epsilon(0.002));
    CHECK(mean(layer + "_diffuse") ==
          Approx(albedo * albedo * geometricSeries(albedo, bounces)).epsilon(0.003));
    CHECK(mean(layer + "_glossy") == 0.0);
    CHECK(estimateOf(image, layer).deviation > 0.0);
  }
  CHECK(image.layers.count("bounces_3") == 0);
  CHECK(image.attributes.at("bounce_layers") == "1 2 4");
}

TEST_CASE("layers of numbers of bounces leave the others as they are, and begin and end with them") {
  for (const bool media : {false, true}) {
    CAPTURE(media);
    Scene scene = litRoom(16, 16);
    scene.environment = glm::vec3(0.5f);
    if (media) {
      scene.media.push_back({});
      scene.media[0].extinction = glm::vec3(0.5f);
      scene.media[0].albedo = glm::vec3(0.8f);
    }
    const LayeredImage plain = renderReference(scene, quietly(8, 4));
    ReferenceOptions options = quietly(8, 4);
    options.bounceLayers = {1, 2, 4};
    const LayeredImage image = renderReference(scene, options);
    for (const auto& [name, layer] : plain.layers) {
      CAPTURE(name);
      CHECK(image.layers.at(name).values() == layer.values());
    }
    CHECK(image.layers.size() == plain.layers.size() + 18);
    const auto difference = [&](const std::string& a, const std::string& b) {
      double largest = 0.0;
      for (std::size_t i = 0; i < image.layers.at(a).values().size(); ++i)
        largest = std::max(largest, std::abs(static_cast<double>(image.layers.at(a).values()[i]) -
                                             static_cast<double>(image.layers.at(b).values()[i])));
      return largest;
    };
    // Sums in another order: within rounding.
    const double full = estimateOf(image, "full").mean;
    CHECK(full > 0.0);
    CHECK(difference("bounces_4", "full") < 1e-4 * full);
    CHECK(difference("bounces_4_diffuse", "indirect_diffuse") < 1e-4 * full);
    CHECK(difference("bounces_4_glossy", "indirect_glossy") < 1e-4 * full);
    CHECK(estimateOf(image, "bounces_1_glossy").mean > 0.0);
    // With media a scattering is a bounce, which one_bounce leaves out.
    const double once = estimateOf(image, "one_bounce").mean, first = estimateOf(image, "bounces_1").mean,
                 second = estimateOf(image, "bounces_2").mean;
    if (media) {
      CHECK(first > 1.001 * once);
    } else {
      CHECK(difference("bounces_1", "one_bounce") < 1e-4 * full);
      CHECK(difference("bounces_1_diffuse", "one_bounce_diffuse") < 1e-4 * full);
    }
    CHECK(second > first);
    CHECK(full > second);
  }
}

TEST_CASE("a number of bounces beyond those of the paths has no layer") {
  for (const int wrong : {0, -1, 3}) {
    ReferenceOptions options = quietly(4, 2);
    options.bounceLayers = {1, wrong};
    CHECK_THROWS_MATCHES(renderReference(furnace(0.5f, 1.0f, 4), options), Error,
                         Tells("a number of bounces with layers of its own is " + std::to_string(wrong)));
  }
}

TEST_CASE("with one bounce the indirect layers are the one-bounce layers; with none they are black") {
  Scene scene = litRoom(16, 16);
  scene.environment = glm::vec3(0.5f);
  const LayeredImage one = renderReference(scene, quietly(4, 1));
  CHECK(one.layers.at("indirect_diffuse").values() == one.layers.at("one_bounce_diffuse").values());
  CHECK(one.layers.at("indirect_glossy").values() == one.layers.at("one_bounce_glossy").values());
  CHECK(estimateOf(one, "one_bounce_glossy").mean > 0.0);
  const LayeredImage none = renderReference(scene, quietly(4, 0));
  CHECK(estimateOf(none, "indirect_diffuse").mean == 0.0);
  CHECK(none.layers.at("full").values() == none.layers.at("direct").values());
}

TEST_CASE("no light enters a closed room through its edges or its surfaces") {
  // Turned by an odd angle, so that no wall lies along an axis, and moved far from the world's origin.
  const double angle = 0.7345;
  const glm::dmat4 placement(std::cos(angle), 0.3 * std::sin(angle), -std::sin(angle), 0, 0.1, 1.1, 0.2, 0,
                             std::sin(angle), -0.2, std::cos(angle), 0, 1.0e5, -3.0e5, 2.0e5, 1);
  for (const bool smooth : {false, true}) {
    CAPTURE(smooth);
    SceneBuilder builder;
    builder.box({-1, -1, -1}, {1, 1, 1}, builder.phong(0.5f, 0.4f, 5.0f), true);
    if (smooth) {  // normals of a ball: far from the geometric ones
      for (std::size_t i = 0; i < builder.scene.positions.size(); ++i) {
        builder.scene.normals[i] = -glm::normalize(builder.scene.positions[i]);
      }
    }
    for (Object& object : builder.scene.objects) object.placement = placement;
    builder.scene.environment = glm::vec3(1.0e6f);
    builder.light(LightKind::directional, glm::vec3(1.0e6f), {}, {0.3, -1, 0.2});
    builder.light(LightKind::point, glm::vec3(1.0e6f), glm::dvec3(placement * glm::dvec4(0, 1.5, 0, 1)));
    ReferenceOptions options = quietly(32, 8);
    options.roulette = false;
    // Into the room at large, and at a millionth of a radian around points of its edges and corners.
    for (const glm::dvec4 target :
         {glm::dvec4(0, 0, 0, 1), glm::dvec4(-1, -1, 0.3, 1), glm::dvec4(0.2, -1, -1, 1),
          glm::dvec4(-1, 0.7, -1, 1), glm::dvec4(-1, -1, -1, 1), glm::dvec4(1, -1, -1, 1)}) {
      CAPTURE(target.x, target.y, target.z);
      builder.look(glm::dvec3(placement * glm::dvec4(0.9, 0.8, 0.7, 1)), glm::dvec3(placement * target),
                   {0, 1, 0}, target == glm::dvec4(0, 0, 0, 1) ? 2.0 : 1e-6, 32, 32);
      CHECK(estimateOf(renderReference(builder.scene, options), "full").mean == 0.0);
    }
  }
}
