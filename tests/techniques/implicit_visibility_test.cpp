// Input that gives little or nothing to link, or too much.
#include <algorithm>
#include <cmath>

#include "lumivox/base/error.h"
#include "lumivox/base/log.h"
#include "support/closed_room.h"
#include "support/surface_elements.h"

using namespace lumivox;
using namespace lumivox::test;

TEST_CASE(
    "islands of the texture coordinates are segments; without them charts are, and the object is named") {
  SceneBuilder builder;
  builder.box({0, 0, 0}, {1, 1, 1}, builder.lambert(0.5f), true);
  builder.mesh({{2, 0, 0}, {3, 0, 0}, {2, 1, 0}, {3, 1, 0}, {2, 1, 0}, {3, 0, 0}}, builder.lambert(0.5f))
      .name = "plain";
  const LogCapture log;
  const LinkedScene made = linked(builder.scene, {{{"elements", 128}, {"segments", "uv"}}, {}, {}});
  CHECK(made.tree().segments.size() == 7);
  CHECK_THAT(log.text(), Catch::Contains("'plain' has no texture coordinates; its charts are used"));
}

TEST_CASE("a scene without a triangle has neither elements nor links") {
  SceneBuilder builder;
  const LinkedScene made = linked(builder.scene, {});
  CHECK(made.tree().leafCount == 0);
  CHECK(made.tree().root == kNoElement);
  CHECK(made.links.seen->values.empty());
}

TEST_CASE("too many links for the memory there is are refused before anything is made") {
  const Scene scene = closedCube();
  const SurfaceElements elements = LonePass("implicit_visibility.elements", scene, {{"elements", 200000}})
                                       .out<SurfaceElements>("elements");
  for (const std::string name : {"create_links", "push_links"}) {
    LonePass pass("implicit_visibility." + name, scene);
    pass.in("elements", elements);
    ElementLinks none;
    none.bins = 64;
    if (name == "create_links")
      pass.with({{"bins", 64}});
    else
      pass.in("links", none);
    CHECK_THAT(
        messageOf<Error>([&] { pass.run(); }),
        Catch::Matches(".*links of \\d+ elements with 6 x 64 x 64 bins need [0-9.]+ [KMGT]iB; memory has "
                       "[0-9.]+ [KMGT]iB, enough for about \\d+ elements"));
  }
}

TEST_CASE("more links than a buffer of the device takes are refused before it is made, with what would fit") {
  const std::uint64_t most = device().info().maxStorageBytes;
  if (most > (std::uint64_t{1} << 28)) return;  // more than a test should take
  // In a closed room each leaf has a link in each of the 12288 bins of its front.
  const double leaves = std::ceil(1.1 * static_cast<double>(most) / (12288.0 * sizeof(ElementLink)));
  const std::string message = messageOf<Error>([&] {
    linked(closedCube(), {{{"elements", leaves}}, {{"bins", 64}}, {}});
  });
  CHECK_THAT(message,
             Catch::Matches(".*links of \\d+ elements with 6 x 64 x 64 bins need [0-9.]+ MiB; a buffer of "
                            "the device has [0-9.]+ MiB, enough for about \\d+ elements"));
}

TEST_CASE("two triangles that nearly lie on each other are linked without a number that is none") {
  SceneBuilder builder;
  builder.mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1e-7f}, {0, 1, 0}, {1, 0, 0}}, builder.lambert(0.5f));
  for (const std::string source : {"atlas", "vertices"})
    for (const double bins : {1.0, 64.0}) {
      const LinkedScene made =
          linked(builder.scene, {{{"elements", 16}, {"source", source}}, {{"bins", bins}}, {}});
      for (const ElementLink& link : made.links.seen->values) {
        CHECK(std::isfinite(link.distance()));
        CHECK(link.node < made.tree().nodeCount);
        CHECK(link.bin() < 6 * bins * bins);
      }
    }
}

TEST_CASE("of elements in closed rooms the share of bins that hold no link is told when a run is inspected") {
  const auto noteOn = [](const Scene& scene, const std::vector<std::string>& settings) {
    const Pipeline text = pipeline("implicit_visibility");
    RenderOptions options;
    options.width = 16, options.height = 12;
    options.health = true;
    options.parameters = text.settings(settings);
    PipelineExecutor executor(device(), techniques(), scene, text, options);
    std::string found;
    for (const std::string& note : executor.render(0.0).notes)
      if (note.find("% of the bins of elements in closed rooms hold no link") != std::string::npos)
        found = note.substr(note.find_last_of(' ', note.find('%') - 2) + 1);
    return found;
  };
  for (const char* bins : {"bins=1", "bins=7", "bins=8"})
    CHECK(noteOn(furnishedCube(), {"elements=256", bins}) != "");
  CHECK(std::stod(noteOn(furnishedCube(), {"elements=1024"})) < 0.5);
  // Too few elements for the bins.
  CHECK(std::stod(noteOn(furnishedCube(), {"elements=256", "bins=12", "fill=one"})) > 30.0);
  // Most bins of elements below the sky are empty, as they should be.
  SceneBuilder builder;
  builder.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, builder.lambert(0.5f));
  builder.quad({-1, 0, -1}, {2, 0, 0}, {0, 2, 0}, 0);
  builder.scene.environment = glm::vec3(1.0f);
  builder.look({0, 2, 2}, {0, 0, 0}, {0, 1, 0}, 0.8, 16, 12);
  CHECK(noteOn(builder.scene, {"elements=256"}).empty());
}
