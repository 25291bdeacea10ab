// What is shown as published: values at vertices, interpolated over triangles, and the switch that sets all
// printed words.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "lumivox/base/error.h"
#include "support/facts.h"
#include "support/half_masked_sheet.h"
#include "support/kept_table.h"
#include "support/placed.h"
#include "support/scene_builder.h"
#include "support/surface_elements.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

constexpr int kPixels = 48;

/// A scene's elements at its vertices, what its camera sees, and light that the test chooses.
struct Shown {
  const Scene& scene;
  SceneSnapshot snapshot;
  GBuffer gbuffer;
  SurfaceElements elements;
  LonePass display;

  explicit Shown(const Scene& shownScene, double time = 0.0, const char* source = "vertices")
      : scene(shownScene),
        snapshot(snapshotOf(scene, time, {}, kPixels, kPixels)),
        gbuffer(LonePass("direct_lighting.gbuffer", scene, {}, snapshot).out<GBuffer>("gbuffer")),
        elements(LonePass("implicit_visibility.elements", scene, {{"source", source}}, snapshot)
                     .out<SurfaceElements>("elements")),
        display("implicit_visibility.display", scene, {{"interpolate", "vertices"}}, snapshot) {
    display.in("gbuffer", gbuffer).in("elements", elements);
  }

  /// What is shown of the irradiance `ofLeaf(leaf, side)`.
  template <class OfLeaf>
  ImageBuffer diffuse(OfLeaf&& ofLeaf) {
    const glm::ivec2 size = SurfaceElements::sizeFor(2 * elements.leafCount);
    std::vector<glm::vec4> texels(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y));
    for (int leaf = 0; leaf < elements.leafCount; ++leaf)
      for (int side = 0; side < 2; ++side)
        texels[static_cast<std::size_t>(2 * leaf + side)] =
            glm::vec4(ofLeaf(static_cast<std::uint32_t>(leaf), side), 1.0f);
    ElementLight light;
    light.irradiance = filled(pixels(size.x, size.y), glm::vec4(0.0f));
    light.irradiance->upload(0, std::as_bytes(std::span(texels)));
    light.radiance = light.irradiance;
    return display.in("light", light).image("diffuse");
  }
  ImageBuffer positions() { return imageOf(*gbuffer.position, 4); }
  ImageBuffer albedos() { return imageOf(*gbuffer.diffuse); }
};

/// Positions are linear over every triangle: shown as irradiance they are those of the g-buffer in each
/// pixel, or the surface that is shown is another.
void checkShowsPositions(Shown& shown) {
  const glm::vec3 shift(50.0f);
  const ImageBuffer image =
      shown.diffuse([&](std::uint32_t leaf, int) { return shown.elements.state->position[leaf] + shift; });
  const ImageBuffer positions = shown.positions(), albedos = shown.albedos();
  int seen = 0;
  double worst = 0.0;
  for (int y = 0; y < kPixels; ++y)
    for (int x = 0; x < kPixels; ++x) {
      const bool isSurface = positions.at(x, y, 3) != 0.0f;
      seen += isSurface;
      for (int c = 0; c < 3; ++c) {
        const double expected =
            isSurface ? albedos.at(x, y, c) / kPi * static_cast<double>(positions.at(x, y, c) + shift[c])
                      : 0.0;
        worst = std::max(worst, std::abs(image.at(x, y, c) - expected));
      }
    }
  CHECK(seen > kPixels * kPixels / 10);
  CHECK(worst < 2e-4);
}

SceneBuilder oneTriangle() {
  SceneBuilder builder;
  builder.mesh({{-1, 0, 0.5f}, {1.2f, 0, 0.3f}, {0.1f, 0, -1}}, builder.lambert(0.5f));
  builder.look({0.4, 1.2, 1.0}, {0, 0, -0.2}, {0, 1, 0}, 0.9, kPixels, kPixels);
  return builder;
}

}  // namespace

TEST_CASE(
    "irradiance at the corners of a triangle is interpolated by barycentric coordinates, on the side seen") {
  for (const double height : {1.2, -1.2}) {
    SceneBuilder builder = oneTriangle();
    builder.look({0.4, height, 1.0}, {0, 0, -0.2}, {0, 1, 0}, 0.9, kPixels, kPixels);
    Shown shown(builder.scene);
    REQUIRE(shown.elements.leafCount == 3);
    // Its front, counter-clockwise, is below or above; of each side another light.
    const auto light = [](std::uint32_t leaf, int side) {
      return glm::vec3(1.0f + 2.0f * static_cast<float>(leaf), leaf == 1 ? 7.0f : 0.5f,
                       side == 0 ? 3.0f : 11.0f);
    };
    const ImageBuffer image = shown.diffuse(light), positions = shown.positions();
    const std::vector<glm::vec3>& corners = shown.elements.state->position;
    const glm::dvec3 normal(shown.elements.state->normal[0]);
    const int side = normal.y * height > 0.0 ? 0 : 1;
    const glm::dvec3 a(corners[0]), b(corners[1]), c(corners[2]);
    const glm::dvec3 across = glm::cross(b - a, c - a);
    const double all = glm::dot(across, across);
    int seen = 0;
    for (int y = 0; y < kPixels; ++y)
      for (int x = 0; x < kPixels; ++x) {
        if (positions.at(x, y, 3) == 0.0f) {
          CHECK(image.at(x, y, 0) == 0.0f);
          continue;
        }
        ++seen;
        const glm::dvec3 p(positions.at(x, y, 0), positions.at(x, y, 1), positions.at(x, y, 2));
        const double ofB = glm::dot(glm::cross(p - a, c - a), across) / all,
                     ofC = glm::dot(glm::cross(b - a, p - a), across) / all;
        const glm::dvec3 expected = 0.5 / kPi *
                                    ((1.0 - ofB - ofC) * glm::dvec3(light(0, side)) +
                                     ofB * glm::dvec3(light(1, side)) + ofC * glm::dvec3(light(2, side)));
        for (int k = 0; k < 3; ++k) CHECK(image.at(x, y, k) == Approx(expected[k]).epsilon(1e-4));
      }
    CAPTURE(height);
    CHECK(seen > 100);
  }
}

TEST_CASE(
    "what is shown at vertices lines up with the g-buffer: hidden surfaces, turned, deformed, mirrored") {
  SECTION("of surfaces one before the other") {
    Scene scene = litRoom(kPixels, kPixels);
    Shown shown(scene);
    checkShowsPositions(shown);
  }
  SECTION("of what turns") {
    const Scene scene = loadScene(sourceDirectory() / "scenes/spinning_box.scene");
    Shown shown(scene, 0.7);
    checkShowsPositions(shown);
  }
  SECTION("of what deforms") {
    const Scene scene = loadScene(sourceDirectory() / "scenes/waving_cloth.scene");
    Shown shown(scene, 0.3);
    checkShowsPositions(shown);
  }
  SECTION("of what a placement mirrors") {
    SceneBuilder builder = oneTriangle();
    place(builder.scene, builder.scene.objects[0], glm::dmat4(glm::dmat3(-1, 0, 0, 0, 1, 0, 0, 0, 1)));
    Shown shown(builder.scene);
    checkShowsPositions(shown);
  }
}

TEST_CASE(
    "of a sheet whose left half a mask cuts away only the rest is shown, and its corners without an element "
    "leave the value to the others") {
  SceneBuilder builder;
  addHalfMaskedSheet(builder);
  builder.look({0, 3, 0}, {0, 0, 0}, {0, 0, -1}, 0.7, kPixels, kPixels);
  Shown shown(builder.scene);
  const auto lightAt = [](float height) { return height < 0.25f ? 8.0f : 4.0f; };
  const ImageBuffer image = shown.diffuse(
      [&](std::uint32_t leaf, int) { return glm::vec3(lightAt(shown.elements.state->position[leaf].y)); });
  const ImageBuffer positions = shown.positions(), albedos = shown.albedos();
  int holes = 0;
  for (int y = 0; y < kPixels; ++y)
    for (int x = 0; x < kPixels; ++x)
      if (positions.at(x, y, 3) != 0.0f) {
        CHECK(image.at(x, y, 0) ==
              Approx(lightAt(positions.at(x, y, 1)) / kPi * albedos.at(x, y, 0)).epsilon(1e-5));
        holes += positions.at(x, y, 1) < 0.25f;
      }
  CHECK(holes > 100);
}

TEST_CASE("values at vertices need elements there: with those of the atlas the message names the word") {
  const SceneBuilder builder = oneTriangle();
  Shown shown(builder.scene, 0.0, "atlas");
  CHECK_THROWS_MATCHES(shown.diffuse([](std::uint32_t, int) { return glm::vec3(1.0f); }), Error,
                       Tells("interpolate vertices", "source vertices", "implicit_visibility.elements"));
}

TEST_CASE("without a triangle nothing is shown at vertices") {
  SceneBuilder builder;
  builder.look({0, 3, 0}, {0, 0, 0}, {0, 0, -1}, 0.7, kPixels, kPixels);
  Shown shown(builder.scene);
  const ImageBuffer image = shown.diffuse([](std::uint32_t, int) { return glm::vec3(1.0f); });
  for (const float value : image.values()) CHECK(value == 0.0f);
}

TEST_CASE("trees made once beforehand bring the image that trees made with the elements do, to the bit") {
  for (const char* words : {"elements 300", "elements 300 share 0.5", "as_published on"}) {
    const auto shown = [&](const std::string& hierarchy, const std::string& elements) {
      Scene scene = litRoom(kPixels, kPixels);
      scene.environment = {0.5f, 0.6f, 0.7f};
      const std::string text = fmt::format(R"(pipeline "trees" {{
        pass gbuffer direct_lighting.gbuffer {{ }}
        pass shadow direct_lighting.shadow_map {{ }}
        {}
        pass elements implicit_visibility.elements {{ {} }}
        pass pairs implicit_visibility.create_links {{ elements elements.elements }}
        pass links implicit_visibility.push_links {{ elements elements.elements  links pairs.links }}
        pass illuminate implicit_visibility.illuminate {{
          elements elements.elements  links links.links  shadow shadow.depth
        }}
        pass display implicit_visibility.display {{
          gbuffer gbuffer  elements elements.elements  links links.links  light illuminate.light
        }}
        output indirect_diffuse display.diffuse
      }})",
                                           hierarchy, elements);
      return renderOnce(scene, Pipeline::parse(text, "trees.pipeline")).outputs.at("indirect_diffuse");
    };
    CAPTURE(words);
    const ImageBuffer together = shown("", words);
    // The pass's own words have no say where it is given trees, but for those of areas.
    const std::string areas = words == std::string("as_published on") ? "as_published on" : "elements 50";
    const ImageBuffer apart =
        shown(fmt::format("pass hierarchy implicit_visibility.hierarchy {{ {} }}", words),
              "hierarchy hierarchy.hierarchy  " + areas);
    CHECK(together.values() == apart.values());
    CHECK(*std::max_element(together.values().begin(), together.values().end()) > 0.0f);
  }
}

TEST_CASE("'as_published' in every pass is the same image as the printed words set one by one") {
  const auto shown = [](const std::string& elements, const std::string& pairs, const std::string& links,
                        const std::string& illuminate, const std::string& display) {
    Scene scene = litRoom(kPixels, kPixels);
    scene.environment = {0.5f, 0.6f, 0.7f};
    const std::string text = fmt::format(R"(pipeline "published" {{
      pass gbuffer direct_lighting.gbuffer {{ }}
      pass shadow direct_lighting.shadow_map {{ }}
      pass elements implicit_visibility.elements {{ {} }}
      pass pairs implicit_visibility.create_links {{ elements elements.elements  {} }}
      pass links implicit_visibility.push_links {{ elements elements.elements  links pairs.links  {} }}
      pass illuminate implicit_visibility.illuminate {{
        elements elements.elements  links links.links  shadow shadow.depth  bounces 2  {}
      }}
      pass display implicit_visibility.display {{
        gbuffer gbuffer  elements elements.elements  links links.links  light illuminate.light  {}
      }}
      output direct display.direct
      output indirect_diffuse display.diffuse
      output indirect_glossy display.glossy
    }})",
                                         elements, pairs, links, illuminate, display);
    return renderOnce(scene, Pipeline::parse(text, "published.pipeline")).outputs;
  };
  const std::string on = "as_published on";
  const auto words = shown(
      "source vertices segments uv areas rest", "mapping uniform split 1", "fill one push kept",
      "weight element area_light links light_samples 1 directions 0", "interpolate vertices lobe element");
  const auto published = shown(on, on, on, on, on);
  const auto ours = shown("", "", "", "", "");
  const auto differ = [](const ImageBuffer& a, const ImageBuffer& b) {
    return !std::equal(a.values().begin(), a.values().end(), b.values().begin(), b.values().end());
  };
  for (const char* output : {"direct", "indirect_diffuse", "indirect_glossy"}) {
    CAPTURE(output);
    CHECK(!differ(published.at(output), words.at(output)));
    CHECK(differ(published.at(output), ours.at(output)));
  }
}

TEST_CASE(
    "images by the hierarchy and by all pairs differ by at most 5 % RMS of their mean (Fig. 10 b and c)") {
  struct Case {
    const char *pipeline, *scene, *setting;
  };
  for (const Case& one : {Case{"pipelines/implicit_visibility.pipeline", "cornell", "elements=1024"},
                          Case{"reproductions/002_table_1.pipeline", "urn_coarse", "bins=8"}}) {
    const Scene scene = loadScene(sourceDirectory() / "scenes" / (std::string(one.scene) + ".scene"));
    const Pipeline committed = Pipeline::load(sourceDirectory() / "scenes" / one.pipeline);
    std::string text = committed.document->source;
    if (text.find("param method") == std::string::npos) {
      const std::string bins = "    bins $bins\n", bounces = "  param bounces";
      text.insert(text.find(bins), "    method $method\n");
      text.insert(text.find(bounces), "  param method hierarchy in [hierarchy all_pairs]\n");
    }
    const Pipeline chosen = Pipeline::parse(text, committed.file);
    const auto image = [&](const std::string& method) {
      return rendered(scene, chosen, {one.setting, "method=" + method}, sized(kPixels, kPixels))
          .outputs.at("indirect_diffuse");
    };
    const ImageBuffer tree = image("hierarchy"), all = image("all_pairs");
    const double difference = rmsBetween(tree, all) / meanOf(all);
    CAPTURE(one.scene, difference);
    CHECK(difference > 0.0);
    CHECK(difference <= 0.05);
  }
}

TEST_CASE("table: flicker of indirect light that bins add, by their number and mapping", "[.]") {
  // Of changes from frame to frame those that 6 x 32 x 32 bins do not make, over the mean light.
  constexpr int kFrames = 6;
  KeptTable table("implicit_visibility.flicker", {{"flicker", 4, 0.001, 0.05}});
  for (const char* name : {"spinning_box", "horse_gallop"}) {
    const Scene scene = loadScene(sourceDirectory() / ("scenes/" + std::string(name) + ".scene"));
    const auto frames = [&](const std::vector<std::string>& settings) {
      const Pipeline text = pipeline("implicit_visibility");
      RenderOptions options;
      options.width = options.height = 64;
      options.parameters = text.settings(settings);
      PipelineExecutor executor(device(), techniques(), scene, text, options);
      std::vector<std::vector<double>> result;
      for (int frame = 0; frame < kFrames; ++frame) {
        const ImageBuffer image = executor.render(frame / 24.0).outputs.at("indirect_diffuse");
        result.emplace_back(image.values().begin(), image.values().end());
      }
      return result;
    };
    const auto fine = frames({"elements=2048", "bins=32"});
    for (const std::string mapping : {"even", "uniform"}) {
      double before = 1.0;
      for (const int bins : {8, 12, 16}) {
        const auto coarse = frames({"elements=2048", "bins=" + std::to_string(bins), "mapping=" + mapping});
        double squares = 0.0, mean = 0.0;
        for (std::size_t frame = 1; frame < kFrames; ++frame)
          for (std::size_t i = 0; i < fine[frame].size(); ++i) {
            squares +=
                std::pow(coarse[frame][i] - coarse[frame - 1][i] - fine[frame][i] + fine[frame - 1][i], 2.0);
            mean += fine[frame][i];
          }
        const auto count = static_cast<double>((kFrames - 1) * fine[0].size());
        const double flicker = std::sqrt(squares / count) / (mean / count);
        table.row(std::string(name) + ", " + mapping + ", 6 x " + std::to_string(bins) + " x " +
                      std::to_string(bins) + " bins",
                  {flicker});
        CHECK(flicker < before);  // finer bins flicker less
        before = flicker;
      }
    }
  }
}
