// What the camera sees of elements against closed forms.
#include <cmath>

#include "support/element_light.h"
#include "support/form_factors.h"

using namespace lumivox;
using namespace lumivox::test;

TEST_CASE("a floor below a ceiling is open by one minus the form factor of the ceiling, within 3 %") {
  for (const auto& [a, within] : {std::pair(0.5, 100.0), {1.0, 100.0}, {3.0, 100.0}, {1.0, 0.5}}) {
    SceneBuilder builder;
    const int grey = builder.lambert(0.5f);
    builder.quad({-0.2f, 0, -0.2f}, {0, 0, 0.4f}, {0.4f, 0, 0}, grey);
    const auto half = static_cast<float>(a);
    builder.quad({-half, 1, -half}, {2 * half, 0, 0}, {0, 0, 2 * half}, grey);
    builder.look({0, 0.5, 0}, {0, 0, 0}, {0, 0, -1}, 0.02, 4, 4);
    const Pipeline text = Pipeline::parse(R"(pipeline "openness" {
      pass gbuffer direct_lighting.gbuffer { }
      pass elements implicit_visibility.elements { elements 2048 }
      pass pairs implicit_visibility.create_links { elements elements.elements  bins 16 }
      pass links implicit_visibility.push_links { elements elements.elements  links pairs.links }
      param within 100 m in 0..1000 m
      pass display implicit_visibility.display {
        gbuffer gbuffer  elements elements.elements  links links.links  distance $within
      }
      output ambient_occlusion display.occlusion
    })",
                                          "openness.pipeline");
    const double factor = squareAbove(a);
    const ImageBuffer image = rendered(builder.scene, text, {"within=" + std::to_string(within) + "m"})
                                  .outputs.at("ambient_occlusion");
    CAPTURE(a, within, factor);
    // Nothing is near enough to count where the ceiling is farther away.
    CHECK(image.at(2, 2, 0) == Approx(within < 1.0 ? 1.0 : 1.0 - factor).margin(0.03));
  }
}

TEST_CASE("a Phong lobe under a sky of radiance L reflects its albedo times L straight up, within 3 %") {
  // Over the half space the integral of (n + 2) / (2 pi) cos^n cos is 1. The largest exponents are those that
  // the pass notes.
  struct Case {
    const char* bins;
    std::vector<float> exponents;
  };
  for (const Case& one : {Case{"bins=8", {1.0f, 5.0f, 20.0f, 35.0f}}, Case{"bins=12", {1.0f, 20.0f, 80.0f}},
                          Case{"bins=16", {1.0f, 20.0f, 140.0f}}})
    for (const float exponent : one.exponents)
      for (const double slant : {0.0, 0.35}) {
        // Turned about z, the camera with it, so that bins lie elsewhere.
        SceneBuilder builder;
        const glm::dvec3 up(std::sin(slant), std::cos(slant), 0.0),
            along(std::cos(slant), -std::sin(slant), 0.0);
        builder.quad(glm::vec3(-along) - glm::vec3(0, 0, 1), {0, 0, 2}, glm::vec3(2.0 * along),
                     builder.phong(0.0f, 0.5f, exponent));
        builder.look(3.0 * up, {0, 0, 0}, {0, 0, -1}, 0.01, 4, 4);
        builder.scene.environment = glm::vec3(2.0f);
        const ImageBuffer image =
            rendered(builder.scene, pipeline("implicit_visibility"), {"elements=64", one.bins})
                .outputs.at("indirect_glossy");
        CAPTURE(exponent, one.bins, slant);
        CHECK(image.at(2, 2, 0) == Approx(0.5 * 2.0).epsilon(0.03));
      }
}

TEST_CASE("a Phong lobe below a black lid sees neither the sky behind it nor anything else") {
  SceneBuilder builder;
  builder.quad({-0.2f, 0, -0.2f}, {0, 0, 0.4f}, {0.4f, 0, 0}, builder.phong(0.0f, 0.5f, 20.0f));
  builder.quad({-4, 1, -4}, {8, 0, 0}, {0, 0, 8}, builder.lambert(0.0f));
  builder.look({0, 0.5, 0}, {0, 0, 0}, {0, 0, -1}, 0.02, 4, 4);
  builder.scene.environment = glm::vec3(2.0f);
  const ImageBuffer image =
      renderOnce(builder.scene, pipeline("implicit_visibility")).outputs.at("indirect_glossy");
  CHECK(image.at(2, 2, 0) < 0.01);
}

TEST_CASE("of two walls back to back, closer than elements are wide, the one that is seen counts") {
  // The upper one sees the sky; the lower one is 1 cm below, so that its upper side is in the gap. Both turn
  // their fronts outwards, or inwards.
  for (const bool outwards : {true, false}) {
    SceneBuilder builder;
    const int grey = builder.lambert(0.5f);
    const glm::vec3 x(2, 0, 0), z(0, 0, 2);
    builder.quad({-1, 0, -1}, outwards ? z : x, outwards ? x : z, grey);
    builder.quad({-1, -0.01f, -1}, outwards ? x : z, outwards ? z : x, grey);
    builder.look({0, 3, 0}, {0, 0, 0}, {0, 0, -1}, 0.3, 8, 8);
    builder.scene.environment = glm::vec3(2.0f);
    const ImageBuffer image = rendered(builder.scene, pipeline("implicit_visibility"), {"elements=200"})
                                  .outputs.at("indirect_diffuse");
    CAPTURE(outwards);
    CHECK(image.at(4, 4, 0) == Approx(0.5 * 2.0).epsilon(0.01));
  }
}
