// Links of a scene that moves: what stands still is kept, and no bit differs from a fresh run.
#include <algorithm>

#include "lumivox/base/error.h"
#include "support/closed_room.h"
#include "support/surface_elements.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

/// The three passes, and an image so that there is something to render.
Pipeline linksAlone(const std::string& settings) {
  return Pipeline::parse(
      "pipeline \"links alone\" {\n"
      "  pass gbuffer direct_lighting.gbuffer { }\n"
      "  pass shadow direct_lighting.shadow_map { }\n"
      "  pass direct direct_lighting.shade {\n    gbuffer gbuffer\n    shadow shadow.depth\n  }\n"
      "  pass elements implicit_visibility.elements {\n    elements 400\n  }\n"
      "  pass create implicit_visibility.create_links {\n    elements elements\n" +
          settings +
          "  }\n"
          "  pass push implicit_visibility.push_links {\n    elements elements\n    links create.links\n  }\n"
          "  output direct direct.radiance\n"
          "}\n",
      "links_alone.pipeline");
}

const ElementLinks& linksOf(const PipelineExecutor& executor) {
  return kept<ElementLinks>(executor, "push", "links");
}

}  // namespace

TEST_CASE(
    "after any sequence of times links are those of a fresh run, bit for bit, and what stands still is kept") {
  const Scene scene = furnishedCube(true);
  for (const std::string settings : {"", "    method all_pairs\n"}) {
    const Pipeline text = linksAlone(settings);
    PipelineExecutor sequence(device(), techniques(), scene, text, sized(16, 12));
    sequence.keepOutput("push", "links");
    const ElementLists<std::uint32_t>* kept = nullptr;
    std::vector<ElementLink> before;
    int frame = 0;
    for (const double time : {0.0, 0.5, 0.5, 3.0, 0.5, 0.0, 1e6}) {
      sequence.render(time, frame);
      PipelineExecutor fresh(device(), techniques(), scene, text, sized(16, 12));
      fresh.keepOutput("push", "links");
      fresh.render(time);
      CAPTURE(time, frame, settings);
      const ElementLinks &a = linksOf(sequence), &b = linksOf(fresh);
      CHECK(*a.seen == *b.seen);
      CHECK(a.links->download() == b.links->download());
      if (frame == 1 || frame == 3) CHECK(a.seen->values != before);
      before = a.seen->values;
      if (settings.empty()) {
        if (frame > 0) CHECK(a.stillPartners.get() == kept);
        kept = a.stillPartners.get();
      }
      ++frame;
    }
    // What was kept is told; a full update makes the same.
    CHECK(reused(sequence, "hierarchy of elements"));
    CHECK(reused(sequence, "what elements see of what stands still"));
    CHECK(reused(sequence, "links among elements that stand still") == settings.empty());
    RenderOptions everything = sized(16, 12);
    everything.keepEverything = true;
    PipelineExecutor fully(device(), techniques(), scene, text, everything);
    fully.keepOutput("push", "links");
    fully.render(0.0, 0);
    fully.render(1e6, 1);
    CHECK(*linksOf(fully).seen == *linksOf(sequence).seen);
  }
}

TEST_CASE("after any sequence of times light at elements and images are those of a fresh run, bit for bit") {
  Scene scene = furnishedCube(true);
  // A sheet that deforms, and a lamp that shines.
  SceneBuilder builder;
  builder.scene = scene;
  const std::vector<glm::vec3> flat{
      {0.2f, 0.8f, 0.2f}, {0.2f, 0.8f, 0.6f}, {0.8f, 0.8f, 0.6f}, {0.8f, 0.8f, 0.2f}};
  std::vector<glm::vec3> bent = flat;
  bent[1].y = 0.65f, bent[3].x = 0.6f;
  Object& sheet = builder.quad(flat[0], flat[1] - flat[0], flat[3] - flat[0], builder.lambert(0.7f));
  VertexSequence sequence;
  sequence.framesPerSecond = 1.0;
  sequence.positions = {flat, bent};
  sequence.normals.assign(2, std::vector<glm::vec3>(4, glm::vec3(0, 1, 0)));
  sheet.sequence = sequence;
  builder.quad({0.4f, 0.99f, 0.4f}, {0.2f, 0, 0}, {0, 0, 0.2f}, builder.lambert(0.5f, 5.0f));
  builder.light(LightKind::point, glm::vec3(0.2f), {0.5, 0.9, 0.7});
  for (const char* name : {"implicit_visibility", "implicit_visibility_lights"}) {
    const Pipeline text = pipeline(name);
    RenderOptions options = sized(16, 12);
    options.parameters = text.settings({"elements=400", "bounces=2"});
    const auto executorOf = [&] {
      auto executor =
          std::make_unique<PipelineExecutor>(device(), techniques(), builder.scene, text, options);
      executor->keepOutput("illuminate", "light");
      return executor;
    };
    const auto radianceOf = [](const PipelineExecutor& executor) {
      return kept<ElementLight>(executor, "illuminate", "light").radiance->downloadFloats(0);
    };
    const auto sequenceOf = executorOf();
    std::vector<float> before;
    int frame = 0;
    for (const double time : {0.0, 0.4, 0.8, 0.4, 1e6, 0.0}) {
      CAPTURE(name, time);
      const FrameResult result = sequenceOf->render(time, frame++);
      const auto fresh = executorOf();
      const FrameResult alone = fresh->render(time);
      const std::vector<float> radiance = radianceOf(*sequenceOf);
      CHECK(radiance == radianceOf(*fresh));
      CHECK(radiance != before);
      before = radiance;
      for (const auto& [output, image] : result.outputs)
        CHECK(image.values() == alone.outputs.at(output).values());
    }
  }
}

TEST_CASE("in a scene that stands still links are made once, whatever the camera does") {
  Scene scene = furnishedCube(false);
  scene.cameras.front().keys = {{0.0, {0.5, 0.5, 0.95}, {0.5, 0.5, 0}},
                                {1.0, {0.3, 0.5, 0.9}, {0.5, 0.4, 0}}};
  const Pipeline text = linksAlone("");
  PipelineExecutor executor(device(), techniques(), scene, text, sized(16, 12));
  executor.keepOutput("push", "links");
  executor.render(0.0, 0);
  const ElementLists<ElementLink>* first = linksOf(executor).seen.get();
  const FrameResult second = executor.render(1.0, 1);
  CHECK(linksOf(executor).seen.get() == first);
}
