// What glossy surfaces send on: the flux of Phong lobes in maps, and lights on surfaces that have lobes.
#include <cmath>

#include "lumivox/base/random.h"
#include "support/against_reference.h"
#include "support/glsl_functions.h"
#include "support/kept_table.h"
#include "support/phong_lobes.h"
#include "support/reflective_shadow_maps.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

const std::vector<std::string> kLobes{"common/constants.glsl", "common/brdf.glsl", "common/rsm.glsl",
                                      "common/surface_lobe.glsl"};

/// A floor of 2 m x 2 m under a sun that shines at 45 degrees.
SceneBuilder floorUnderSun(const glm::vec3& specular, float exponent) {
  SceneBuilder builder;
  Material material;
  material.diffuse = glm::vec3(0.3f);
  material.specular = specular;
  material.exponent = exponent;
  builder.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, builder.material(material));
  builder.light(LightKind::directional, glm::vec3(3.0f), {}, {1, -1, 0});
  return builder;
}

/// The map of a pipeline that reads one output of the pass alone.
ReflectiveShadowMap mapOf(const Scene& scene, const std::string& lobes, const std::string& output = "map") {
  const Pipeline text = Pipeline::parse(
      "pipeline \"map\" { pass lights reflective_shadow_maps.render { size 64  lobes " + lobes + " } }",
      "map.pipeline");
  PipelineExecutor executor(device(), techniques(), scene, text, sized(16, 16));
  executor.keepOnly("lights", output);
  executor.render(0.0);
  return kept<ReflectiveShadowMap>(executor, "lights", output);
}

std::vector<float> fluxOf(const Scene& scene, const std::string& lobes, const std::string& output = "map") {
  return mapOf(scene, lobes, output).flux->downloadFloats(0);
}

double sumOfRed(const std::vector<float>& texels) {
  double sum = 0.0;
  for (std::size_t i = 0; i < texels.size(); i += 4) sum += static_cast<double>(texels[i]);
  return sum;
}

}  // namespace

TEST_CASE("the share of light that a Phong lobe reflects is its integral over the hemisphere within 0.004") {
  std::vector<glm::vec4> inputs;
  for (const float exponent : {0.0f, 0.3f, 1.0f, 2.0f, 5.0f, 20.0f, 100.0f, 3000.0f})
    for (const float cosine : {0.0f, 0.05f, 0.2f, 0.5f, 0.8f, 1.0f})
      inputs.emplace_back(exponent, cosine, 0.0f, 0.0f);
  const std::vector<glm::vec4> found = evaluated(kLobes, "found.x = phongAlbedo(given.x, given.y);", inputs);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    CAPTURE(inputs[i].x, inputs[i].y);
    CHECK(std::abs(found[i].x - reflectedShare(inputs[i].x, inputs[i].y)) < 0.004);
  }
}

TEST_CASE(
    "lobes of lights keep direction, width and flux within the steps of their 29 bits, as ordinary floats") {
  std::vector<glm::vec4> inputs;
  RandomStream random(1, 0);
  for (int i = 0; i < 200; ++i) {
    const float z = 2.0f * random.uniform() - 1.0f, turn = 6.2831853f * random.uniform();
    inputs.emplace_back(std::sqrt(1.0f - z * z) * std::cos(turn), std::sqrt(1.0f - z * z) * std::sin(turn), z,
                        std::exp2(14.0f * random.uniform()) - 1.0f);
  }
  const std::vector<glm::vec4> lobes =
      evaluated(kLobes, "found = unpackLobe(packLobe(given.xyz, given.w));", inputs);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    CHECK(glm::distance(glm::vec3(lobes[i]), glm::vec3(inputs[i])) < 0.002f);
    CHECK((lobes[i].w + 1.0f) / (inputs[i].w + 1.0f) == Approx(1.0).epsilon(0.046));
  }
  std::vector<glm::vec4> fluxes{
      {0, 0, 0, 0}, {1, 1, 1, 0}, {2, 0.5f, 0, 0}, {1e-20f, 3e-21f, 0, 0}, {3e30f, 1e30f, 2e30f, 0}};
  const std::vector<glm::vec4> kept = evaluated(
      kLobes,
      "float word = packFlux(given.rgb); found = vec4(unpackFlux(word), isnan(word) || isinf(word) ? 1.0 : 0.0);",
      fluxes);
  for (std::size_t i = 0; i < fluxes.size(); ++i) {
    const float largest = std::max({fluxes[i].x, fluxes[i].y, fluxes[i].z});
    CHECK(kept[i].w == 0.0f);
    for (int c = 0; c < 3; ++c) CHECK(std::abs(kept[i][c] - fluxes[i][c]) <= largest / 64.0f);
  }
}

TEST_CASE(
    "a glossy floor's texels sum to what both of its lobes reflect, and without lobes to its diffuse light") {
  const double cosine = std::sqrt(0.5), arriving = 3.0 * cosine * 4.0;
  for (const float exponent : {0.0f, 2.0f, 40.0f}) {
    const Scene scene = floorUnderSun(glm::vec3(0.5f), exponent).scene;
    const double share = reflectedShare(exponent, cosine);
    for (const char* lobes : {"diffuse", "directional"})
      CHECK(sumOfRed(fluxOf(scene, lobes)) == Approx((0.3 + 0.5 * share) * arriving).epsilon(0.01));
    CHECK(sumOfRed(fluxOf(scene, "none")) == Approx(0.3 * arriving).epsilon(0.01));
  }
}

TEST_CASE("a map of matte surfaces is the same to the bit whatever lobes add, and holds none") {
  const Scene scene = floorUnderSun(glm::vec3(0.0f), 0.0f).scene;
  const std::vector<float> none = fluxOf(scene, "none");
  for (const char* lobes : {"diffuse", "directional"}) {
    CHECK(fluxOf(scene, lobes) == none);
    CHECK(mapOf(scene, lobes).specular == nullptr);
  }
}

TEST_CASE("the map for paths has diffuse flux alone, since paths reflect by the lobes themselves") {
  const Scene scene = floorUnderSun(glm::vec3(0.5f), 10.0f).scene;
  CHECK(fluxOf(scene, "diffuse", "surfaces") == fluxOf(scene, "none"));
}

TEST_CASE("a light with a lobe sends all of its flux, and most of it along the mirror direction") {
  // Over the hemisphere, weighed by the cosine over pi, the flux towards a direction has the light's flux as
  // its mean, whatever the lobe.
  constexpr int kSide = 48;
  for (const float exponent : {0.0f, 3.0f, 30.0f})
    for (const float tilt : {0.0f, 0.6f, 1.2f}) {
      std::vector<glm::vec4> directions;
      for (int i = 0; i < kSide * kSide; ++i) {
        const float radius = std::sqrt((static_cast<float>(i / kSide) + 0.5f) / kSide),
                    turn = 6.2831853f * (static_cast<float>(i % kSide) + 0.5f) / kSide;
        directions.emplace_back(radius * std::cos(turn), std::sqrt(1.0f - radius * radius),
                                radius * std::sin(turn), 0.0f);
      }
      directions.emplace_back(std::sin(tilt), std::cos(tilt), 0.0f, 0.0f);
      const std::vector<glm::vec4> found = evaluated(
          kLobes,
          fmt::format("SurfaceLight light = SurfaceLight(vec4(0.0, 0.0, 0.0, 0.01), vec4(0.0, 1.0, 0.0, "
                      "packLobe(vec3({0:.8f}, {1:.8f}, 0.0), {2:.3f})), vec4(vec3(1.0 + 2.0 * "
                      "phongAlbedo({2:.3f}, {1:.8f})), packFlux(vec3(2.0))));\n"
                      "found.rgb = fluxTowards(light, 3.0 * given.xyz);",
                      std::sin(tilt), std::cos(tilt), exponent),
          directions);
      double mean = 0.0;
      for (std::size_t i = 0; i + 1 < found.size(); ++i) mean += static_cast<double>(found[i].x);
      mean /= kSide * kSide;
      CAPTURE(exponent, tilt);
      const double share = reflectedShare(exponent, std::cos(static_cast<double>(tilt)));
      CHECK(mean == Approx(1.0 + 2.0 * share).epsilon(0.02));
      CHECK(found.back().x == Approx(1.0 + exponent + 2.0).epsilon(0.06));
    }
}

TEST_CASE(
    "what a gold box and a polished floor send on brings the light of the room to within 0.1 of its energy") {
  const Scene scene = committed("cornell_glossy");
  const Picture picture{48, 48, 128};
  const LayeredImage reference = referenceOf(scene, picture);
  struct Case {
    const char* pipeline;
    std::vector<std::string> settings;
    double error;  ///< at most, over that of none
  };
  for (const Case& one : {Case{"reflective_shadow_maps", {"samples=1600"}, 0.25},
                          Case{"virtual_area_lights", {}, 0.25}, Case{"near_field_voxels", {"rays=128"}, 0.3},
                          Case{"light_propagation_volumes", {"lobes=diffuse"}, 0.6}}) {
    const auto errorWith = [&](const std::string& lobes) {
      std::vector<std::string> settings = one.settings;
      settings.push_back("lobes=" + lobes);
      return lightAgainst(
          reference,
          pictured(scene, picture, pipeline(one.pipeline), settings).outputs.at("indirect_diffuse"));
    };
    const bool turns = one.settings != std::vector<std::string>{"lobes=diffuse"};
    const Against none = errorWith("none"), best = errorWith(turns ? "directional" : "diffuse");
    CAPTURE(one.pipeline, none.rmse, none.ratio, best.rmse, best.ratio);
    CHECK(none.ratio < 0.9);
    CHECK(best.ratio == Approx(1.0).margin(0.1));
    CHECK(best.rmse < one.error);
    CHECK(best.rmse < 0.9 * none.rmse);
  }
}

TEST_CASE("table: errors of light that glossy surfaces send on, by what maps keep of their lobes", "[.]") {
  // The last two scenes are committed ones on which nothing was tuned, here with every surface polished.
  const std::vector<std::pair<std::string, Scene>> scenes{
      {"cornell_glossy", committed("cornell_glossy")},
      {"arcade", committed("arcade")},
      {"untuned/room, polished", polished("untuned/room")},
      {"untuned/turning_corridor, polished", polished("untuned/turning_corridor")}};
  KeptTable table("reflective_shadow_maps.lobes",
                  {{"diffuse", 3, 0.01, 0.03}, {"ratio of diffuse", 3, 0.01}});
  const Picture picture{64, 64, 512};
  for (const auto& [name, scene] : scenes) {
    const LayeredImage reference = referenceOf(scene, picture);
    for (const auto& [text, settings] : std::vector<std::pair<std::string, std::vector<std::string>>>{
             {"reflective_shadow_maps", {}},
             {"reflective_shadow_maps", {"samples=1600"}},
             {"virtual_area_lights", {}},
             {"near_field_voxels", {}},
             {"near_field_voxels", {"rays=256"}},
             {"light_propagation_volumes", {}},
             {"layered_reflective_shadow_maps", {}},
             {"voxel_cone_tracing_octree_photons", {}}}) {
      double withNone = 0.0;
      for (const char* lobes : {"none", "diffuse", "directional"}) {
        const Pipeline one = pipeline(text);
        const bool turns =
            text == "reflective_shadow_maps" || text == "virtual_area_lights" || text == "near_field_voxels";
        if (!turns && lobes == std::string("directional")) continue;
        std::vector<std::string> all = settings;
        all.push_back(std::string("lobes=") + lobes);
        const Against found =
            lightAgainst(reference, pictured(scene, picture, one, all).outputs.at("indirect_diffuse"));
        table.row(
            fmt::format("{}, {}{}, {}", name, text, settings.empty() ? "" : ' ' + settings.front(), lobes),
            {found.rmse, found.ratio});
        CAPTURE(name, text, lobes);
        if (lobes == std::string("none"))
          withNone = found.ratio;
        else
          CHECK(found.ratio > withNone);
      }
    }
  }
}
