// The Phong lobe, the environment, occlusion, motion, noise and independence of the threads.
#include <algorithm>

#include "lumivox/base/error.h"
#include "lumivox/reference/path_tracer.h"
#include "support/facts.h"
#include "support/scene_builder.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

/// A plane through the origin facing up, in an environment of radiance 1, seen at one point under an angle
/// from its normal.
Scene planeInEnvironment(float diffuse, float specular, float exponent, double angle) {
  SceneBuilder builder;
  builder.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, builder.phong(diffuse, specular, exponent));
  builder.scene.environment = glm::vec3(1.0f);
  // A field of view of a thousandth of a degree: all pixels look along one direction.
  builder.look({std::sin(angle), std::cos(angle), 0}, {0, 0, 0}, {0, 0, 1}, 2e-5, 16, 16);
  return builder.scene;
}

/// Reflectance of the unit Phong lobe under a constant environment: the integral over the upper hemisphere of
/// (n+2)/(2 pi) max(0, cos a)^n cos(theta), by the midpoint rule over directions about the mirror direction.
double lobeReflectance(double exponent, double angle) {
  const glm::dvec3 mirror(-std::sin(angle), std::cos(angle), 0), side(std::cos(angle), std::sin(angle), 0),
      across(0, 0, 1);
  constexpr int kSteps = 1000;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    // Uniform steps of c = cos^(n+1) a make the lobe's weight uniform: cos^n a sin a da = dc / (n+1).
    const double cosine = std::pow((i + 0.5) / kSteps, 1.0 / (exponent + 1.0)),
                 sine = std::sqrt(1.0 - cosine * cosine);
    for (int k = 0; k < kSteps; ++k) {
      const double turn = 2.0 * kPi * (k + 0.5) / kSteps;
      const glm::dvec3 direction = cosine * mirror + sine * (std::cos(turn) * side + std::sin(turn) * across);
      sum += std::max(0.0, direction.y);
    }
  }
  return (exponent + 2.0) / (exponent + 1.0) * sum / (double(kSteps) * kSteps);
}

}  // namespace

TEST_CASE("a Phong lobe at normal incidence in a constant environment reflects its albedo") {
  // Its integral is (n+2) times that of cos^(n+1) a sin a over a quarter turn, which is 1/(n+2).
  for (const float exponent : {0.0f, 1.0f, 20.0f, 1000.0f}) {
    CAPTURE(exponent);
    const LayeredImage image =
        renderReference(planeInEnvironment(0.0f, 0.8f, exponent, 0.0), quietly(256, 1));
    const Estimate glossy = estimateOf(image, "one_bounce_glossy");
    CHECK(glossy.deviation < 0.002);
    CHECK(glossy.mean == Approx(0.8).epsilon(0.005));
    CHECK(estimateOf(image, "one_bounce_diffuse").mean == 0.0);
    CHECK(estimateOf(image, "direct").mean == 0.0);
  }
}

TEST_CASE("at oblique incidence the part of the Phong lobe below the horizon is lost") {
  for (const float exponent : {1.0f, 8.0f, 60.0f}) {
    for (const double angle : {0.6, 1.2}) {
      CAPTURE(exponent, angle);
      const LayeredImage image =
          renderReference(planeInEnvironment(0.3f, 0.7f, exponent, angle), quietly(512, 1));
      const Estimate glossy = estimateOf(image, "one_bounce_glossy"),
                     diffuse = estimateOf(image, "one_bounce_diffuse");
      CHECK(std::abs(glossy.mean - 0.7 * lobeReflectance(exponent, angle)) < 4.0 * glossy.deviation + 1e-4);
      CHECK(glossy.deviation < 0.004);
      CHECK(std::abs(diffuse.mean - 0.3) < 4.0 * diffuse.deviation + 1e-4);
    }
  }
}

TEST_CASE("a Phong lobe of exponent 0 fills the hemisphere around the mirror direction alone") {
  // Between two half spaces whose normals stand at an angle t, the integral of the cosine to one of them is
  // its projection: half a disc and half an ellipse with the semi-axes 1 and cos t, pi/2 (1 + cos t). The
  // lobe is 2/(2 pi) on it, so it reflects (1 + cos t)/2 of its albedo; the diffuse lobe all of its own.
  for (const double angle : {0.4, 0.9, 1.3}) {
    CAPTURE(angle);
    const LayeredImage image = renderReference(planeInEnvironment(0.3f, 0.7f, 0.0f, angle), quietly(1024, 1));
    const Estimate glossy = estimateOf(image, "one_bounce_glossy"),
                   diffuse = estimateOf(image, "one_bounce_diffuse");
    CHECK(glossy.deviation < 0.003);
    CHECK(diffuse.deviation < 0.003);
    CHECK(std::abs(glossy.mean - 0.7 * 0.5 * (1.0 + std::cos(angle))) < 4.0 * glossy.deviation);
    CHECK(std::abs(diffuse.mean - 0.3) < 4.0 * diffuse.deviation);
  }
}

TEST_CASE("a Phong surface of exponent 0 reflects a point light before its mirror direction alone") {
  for (const bool behind : {false, true}) {
    CAPTURE(behind);
    SceneBuilder builder;
    builder.quad({-9, 0, -9}, {0, 0, 18}, {18, 0, 0}, builder.phong(0.0f, 0.5f, 0.0f));
    // Seen from +x under 1.2 rad; the mirror direction leans to -x. A light on the viewer's side under 1 rad
    // stands 2.2 rad from it, beyond a quarter turn.
    const glm::dvec3 toEye(std::sin(1.2), std::cos(1.2), 0.0);
    const glm::dvec3 toLight = 2.0 * glm::dvec3((behind ? 1.0 : -1.0) * std::sin(1.0), std::cos(1.0), 0.0);
    builder.light(LightKind::point, glm::vec3(4.0f), toLight);
    const double radiance = referenceRadiance(builder.scene, 0.0, toEye, glm::vec3(-toEye), quietly(1)).x;
    const double expected = behind ? 0.0 : 0.5 * 2.0 / (2.0 * kPi) * 4.0 * std::cos(1.0) / 4.0;
    CHECK(radiance == Approx(expected).epsilon(0.001));
  }
}

TEST_CASE("a surface whose albedos add up to one returns no more than it receives") {
  for (const float exponent : {0.0f, 2.0f, 50.0f}) {
    for (const double angle : {0.0, 0.5, 1.0, 1.5}) {
      CAPTURE(exponent, angle);
      const Estimate full = estimateOf(
          renderReference(planeInEnvironment(0.4f, 0.6f, exponent, angle), quietly(64, 4)), "full");
      CHECK(full.mean < 1.0 + 4.0 * full.deviation + 1e-4);
      CHECK(full.mean > 0.4);
    }
  }
}

TEST_CASE("a Phong surface under a point light returns ks (n+2)/(2 pi) cos^n a I cos / d^2") {
  SceneBuilder builder;
  builder.quad({-9, 0, -9}, {0, 0, 18}, {18, 0, 0}, builder.phong(0.0f, 0.5f, 12.0f));
  builder.light(LightKind::point, glm::vec3(4.0f), {1.0, 2.0, 0.5});
  const glm::dvec3 toLight = glm::dvec3(1.0, 2.0, 0.5), toEye = glm::normalize(glm::dvec3(-1.5, 2.0, 0.3));
  const glm::dvec3 mirror(-toEye.x, toEye.y, -toEye.z), direction = glm::normalize(toLight);
  const double expected = 0.5 * 14.0 / (2.0 * kPi) * std::pow(glm::dot(mirror, direction), 12.0) * 4.0 *
                          direction.y / glm::dot(toLight, toLight);
  const double radiance = referenceRadiance(builder.scene, 0.0, toEye, glm::vec3(-toEye), quietly(1)).x;
  CHECK(radiance == Approx(expected).epsilon(0.001));
}

TEST_CASE("interpolated normals tilt the cosine, and directions below the true surface reflect nothing") {
  // Of the cosine-weighted hemisphere about a normal that is tilted by t, the part above the true plane is (1
  // + cos t) / 2.
  const double tilt = 0.8;
  for (const float turned : {1.0f, -1.0f}) {  // normals that point into the ground count as their opposites
    CAPTURE(turned);
    Scene scene = planeInEnvironment(0.6f, 0.0f, 1.0f, 0.3);
    for (glm::vec3& normal : scene.normals) normal = turned * glm::vec3(std::sin(tilt), std::cos(tilt), 0);
    const Estimate full = estimateOf(renderReference(scene, quietly(256, 8)), "full");
    CHECK(std::abs(full.mean - 0.6 * 0.5 * (1.0 + std::cos(tilt))) < 4.0 * full.deviation);
    CHECK(full.deviation < 0.002);
    scene.environment = glm::vec3(0.0f);
    Light sun;
    sun.power = glm::vec3(1.0f);
    sun.direction = -glm::normalize(glm::dvec3(1, 1, 0));
    scene.lights.push_back(sun);
    CHECK(estimateOf(renderReference(scene, quietly(4)), "direct").mean ==
          Approx(0.6 / kPi * std::cos(0.25 * kPi - tilt)).epsilon(0.001));
  }
}

TEST_CASE("rays that miss see the environment, in the direct layer and unoccluded") {
  SceneBuilder builder;
  builder.quad({-1, -5, -1}, {0, 0, 2}, {2, 0, 0}, builder.lambert(0.5f));
  builder.scene.environment = {0.25f, 0.5f, 1.0f};
  builder.look({0, 0, 0}, {0, 1, 0}, {0, 0, 1}, 0.5, 8, 4);
  const LayeredImage image = renderReference(builder.scene, quietly(3));
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 8; ++x) {
      CHECK(image.layers.at("direct").at(x, y, 0) == 0.25f);
      CHECK(image.layers.at("direct").at(x, y, 2) == 1.0f);
      CHECK(image.layers.at("full").at(x, y, 1) == 0.5f);
      CHECK(image.layers.at("full.variance").at(x, y, 1) == 0.0f);
      CHECK(image.layers.at("indirect_diffuse").at(x, y, 1) == 0.0f);
      CHECK(image.layers.at("ambient_occlusion").at(x, y, 0) == 1.0f);
    }
  }
}

TEST_CASE("a scene without triangles is all environment") {
  SceneBuilder builder;
  builder.scene.environment = glm::vec3(2.0f);
  builder.look({0, 0, 1}, {0, 0, 0}, {0, 1, 0}, 0.5, 4, 4);
  CHECK(estimateOf(renderReference(builder.scene, quietly(2)), "full").mean == Approx(2.0));
}

TEST_CASE("ambient occlusion under a ceiling at height h within distance d leaves (h/d)^2 open") {
  // Directions nearer to the normal than acos(h/d) meet the ceiling in time; weighted by the cosine they make
  // up sin^2(acos(h/d)) = 1 - (h/d)^2 of the hemisphere.
  SceneBuilder builder;
  const int grey = builder.lambert(0.5f);
  builder.quad({-200, 0, -200}, {0, 0, 400}, {400, 0, 0}, grey);
  builder.quad({-200, 1, -200}, {400, 0, 0}, {0, 0, 400}, grey);
  builder.look({0, 0.5, 0}, {0, 0, 0}, {0, 0, 1}, 0.8, 16, 16);
  for (const double distance : {0.5, 1.25, 2.0, 5.0}) {
    CAPTURE(distance);
    ReferenceOptions options = quietly(256, 0);
    options.occlusionDistance = distance;
    const Estimate open = estimateOf(renderReference(builder.scene, options), "ambient_occlusion");
    CHECK(std::abs(open.mean - std::min(1.0, 1.0 / (distance * distance))) < 4.0 * open.deviation + 1e-4);
    CHECK(open.deviation < 0.003);
  }
}

TEST_CASE("a moving object stands where its motion puts it at the time of the image") {
  SceneBuilder builder;
  Object& areaLight =
      builder.quad({-0.5f, -0.5f, 0}, {1, 0, 0}, {0, 1, 0}, builder.lambert(0.0f, 3.0f));  // faces +z
  areaLight.motion = RigidMotion{{0, 1, 0}, 0.5 * kPi, {0, 0, 0}, {0, 2, 0}};
  const auto seenFrom = [&](double time, glm::dvec3 eye, glm::vec3 direction) {
    return referenceRadiance(builder.scene, time, eye, direction, quietly(1, 0)).x;
  };
  CHECK(seenFrom(0.0, {0.1, 0.2, 1}, {0, 0, -1}) == 3.0);
  // After a second: a quarter turn about Y, so that it faces +x, and two metres up.
  CHECK(seenFrom(1.0, {0.1, 0.2, 1}, {0, 0, -1}) == 0.0);
  CHECK(seenFrom(1.0, {1, 2.2, 0.1}, {-1, 0, 0}) == 3.0);
}

TEST_CASE("the same scene far from the world's origin gives the same light") {
  SceneBuilder builder;
  builder.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, builder.lambert(0.5f));
  builder.light(LightKind::point, glm::vec3(4.0f), {0, 1, 0});
  const double near = referenceRadiance(builder.scene, 0.0, {0.3, 0.5, 0}, {0, -1, 0}, quietly(1)).x;
  const glm::dvec3 away(5.0e6, -2.0e6, 7.0e6);
  builder.scene.objects[0].placement[3] = glm::dvec4(away, 1.0);
  builder.scene.lights[0].position += away;
  const double far =
      referenceRadiance(builder.scene, 0.0, away + glm::dvec3(0.3, 0.5, 0), {0, -1, 0}, quietly(1)).x;
  CHECK(far == Approx(near).epsilon(1e-5));
}

TEST_CASE("two seeds agree within their own stated noise") {
  const Scene scene = litRoom(48, 48);
  ReferenceOptions options = quietly(128);
  const LayeredImage first = renderReference(scene, options);
  options.seed = 2;
  const LayeredImage second = renderReference(scene, options);
  for (const std::string layer :
       {"direct", "one_bounce_diffuse", "indirect_diffuse", "full", "ambient_occlusion"}) {
    CAPTURE(layer);
    const ImageBuffer &a = first.layers.at(layer), &b = second.layers.at(layer);
    const ImageBuffer &varianceA = first.layers.at(layer + ".variance"),
                      &varianceB = second.layers.at(layer + ".variance");
    CHECK(a.values() != b.values());
    // If the noise is stated honestly, the squared difference in units of its own variance has the
    // expectation 1.
    double squares = 0.0;
    int counted = 0;
    for (std::size_t i = 0; i < a.values().size(); ++i) {
      const double variance = double(varianceA.values()[i]) + varianceB.values()[i];
      const double difference = double(a.values()[i]) - b.values()[i];
      if (variance > 0.0) {
        squares += difference * difference / variance;
        ++counted;
      } else {
        CHECK(difference == Approx(0.0).margin(1e-6));
      }
    }
    REQUIRE(counted > 1000);
    CHECK(squares / counted > 0.9);
    CHECK(squares / counted < 1.1);
    const Estimate meanA = estimateOf(first, layer), meanB = estimateOf(second, layer);
    CHECK(std::abs(meanA.mean - meanB.mean) < 4.0 * std::hypot(meanA.deviation, meanB.deviation));
  }
}

TEST_CASE("the stated noise halves with four times the samples, and the layers add up") {
  const Scene scene = litRoom(24, 24);
  const LayeredImage few = renderReference(scene, quietly(64)), many = renderReference(scene, quietly(256));
  CHECK(estimateOf(few, "full").deviation / estimateOf(many, "full").deviation == Approx(2.0).epsilon(0.15));
  for (std::size_t i = 0; i < many.layers.at("full").values().size(); ++i) {
    const double sum = many.layers.at("direct").values()[i] + many.layers.at("indirect_diffuse").values()[i] +
                       many.layers.at("indirect_glossy").values()[i];
    CHECK(many.layers.at("full").values()[i] == Approx(sum).epsilon(1e-5));
    const double once = many.layers.at("direct").values()[i] +
                        many.layers.at("one_bounce_diffuse").values()[i] +
                        many.layers.at("one_bounce_glossy").values()[i];
    CHECK(many.layers.at("one_bounce").values()[i] == Approx(once).epsilon(1e-5));
  }
}

TEST_CASE("the image does not depend on the number of threads") {
  const Scene scene = litRoom(40, 33);
  ReferenceOptions options = quietly(8);
  options.threads = 1;
  const LayeredImage one = renderReference(scene, options);
  options.threads = 2;
  const LayeredImage two = renderReference(scene, options);
  REQUIRE(one.layers.size() == 16);
  for (const auto& [name, layer] : one.layers) {
    CAPTURE(name);
    CHECK(layer.values() == two.layers.at(name).values());
    CHECK(std::all_of(layer.values().begin(), layer.values().end(),
                      [](float value) { return std::isfinite(value) && value >= 0.0f; }));
  }
}

TEST_CASE("options that make no image are refused by name") {
  const Scene scene = litRoom(4, 4);
  const auto message = [&](auto&& change) {
    ReferenceOptions options = quietly(4);
    change(options);
    return messageOf<Error>([&] { renderReference(scene, options); });
  };
  CHECK_THAT(message([](ReferenceOptions& o) { o.samplesPerPixel = 0; }), Tells("samples per pixel", 0));
  CHECK_THAT(message([](ReferenceOptions& o) { o.samplesPerPixel = 1; }), Tells("at least 2"));
  CHECK_THAT(message([](ReferenceOptions& o) { o.bounces = -1; }), Tells("bounces", -1));
  CHECK_THAT(message([](ReferenceOptions& o) { o.threads = -2; }), Tells("threads", -2));
  CHECK_THAT(message([](ReferenceOptions& o) { o.width = -5; }), Tells("resolution", "-5 x 0"));
  CHECK_THAT(message([](ReferenceOptions& o) { o.time = std::nan(""); }), Tells("time"));
  CHECK_THAT(message([](ReferenceOptions& o) { o.occlusionDistance = -1.0; }), Tells("ambient occlusion"));
  CHECK_THAT(message([](ReferenceOptions& o) { o.camera = "nowhere"; }), Tells("camera", "nowhere"));
}
