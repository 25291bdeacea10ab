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
  const LinkedScene made = linked(builder.scene, {{{"elements", 128.0}, {"segments", "uv"}}, {}, {}});
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
  PassHarness elements(device(), techniques(), "implicit_visibility", "elements", scene,
                       snapshotOf(scene, 0.0));
  elements.setParameter("elements", 200000.0);
  elements.run();
  PassHarness push(device(), techniques(), "implicit_visibility", "push_links", scene,
                   snapshotOf(scene, 0.0));
  push.setInput("elements", elements.output<SurfaceElements>("elements"));
  ElementLinks none;
  none.bins = 64;
  push.setInput("links", none);
  const std::string message = messageOf<Error>([&] { push.run(); });
  CHECK_THAT(message,
             Catch::Contains("elements with 6 x 64 x 64 bins need up to") && Catch::Contains("enough for"));
}

TEST_CASE("two triangles that nearly lie on each other are linked without a number that is none") {
  SceneBuilder builder;
  builder.mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1e-7f}, {0, 1, 0}, {1, 0, 0}}, builder.lambert(0.5f));
  for (const std::string source : {"atlas", "vertices"})
    for (const double bins : {1.0, 64.0}) {
      const LinkedScene made =
          linked(builder.scene, {{{"elements", 16.0}, {"source", source}}, {{"bins", bins}}, {}});
      for (const ElementLink& link : made.links.seen->values) {
        CHECK(std::isfinite(link.distance()));
        CHECK(link.node < made.tree().nodeCount);
        CHECK(link.bin() < 6 * bins * bins);
      }
    }
}

TEST_CASE("the share of bins that hold no link is told when a run is inspected") {
  const Scene scene = furnishedCube();
  const Pipeline text = pipeline("implicit_visibility");
  RenderOptions options;
  options.width = 16, options.height = 12;
  options.health = true;
  options.parameters = text.settings({"elements=256"});
  PipelineExecutor executor(device(), techniques(), scene, text, options);
  const std::vector<std::string> notes = executor.render(0.0).notes;
  CHECK(std::any_of(notes.begin(), notes.end(), [](const std::string& note) {
    return note.find("% of the bins of elements hold no link") != std::string::npos;
  }));
}
