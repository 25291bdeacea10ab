// What moves changes only a part of the octree: the rest is kept, and nothing tells a frame from the first
// one of a fresh run.
#include "support/moving_room.h"
#include "support/octree.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::octree;

namespace {

/// An octree of the room that stays readable.
struct Run {
  explicit Run(const Scene& scene, const char* name = "voxel_cone_tracing_octree", int resolution = 32)
      : executor(device(), techniques(), scene, pipeline(name), options(name, resolution)) {
    executor.keepOutput("bricks", "mips");
  }
  static RenderOptions options(const char* name, int resolution) {
    RenderOptions result;
    result.width = result.height = 8;
    result.parameters = pipeline(name).settings({"resolution=" + std::to_string(resolution)});
    return result;
  }
  const RadianceOctree& at(double time, int frame = 0) {
    executor.render(time, frame);
    return static_cast<const Out<RadianceOctree>*>(executor.output("bricks", "mips"))->value();
  }
  PipelineExecutor executor;
};

void checkSame(const RadianceOctree& a, const RadianceOctree& b) {
  REQUIRE(a.tree.depth == b.tree.depth);
  REQUIRE(a.faces == b.faces);
  CHECK(a.unit == b.unit);
  for (int level = 0; level <= a.tree.depth; ++level) {
    for (int face = 0; face < a.faces; ++face) {
      CAPTURE(level, face);
      const auto first = bricksOf(a, level, face), second = bricksOf(b, level, face);
      CHECK(!first.empty());
      CHECK((first == second));
    }
  }
}

}  // namespace

namespace {

/// Forwards, backwards, the same time again, and a turn further.
void checkAnySequence(const char* name, const Scene& scene) {
  Run run(scene, name);
  int frame = 0;
  for (const double time : {0.0, 0.1, 0.2, 0.5, 0.3, 0.3, 3.0, 2.9}) {
    CAPTURE(name, time);
    checkSame(run.at(time, frame++), Run(scene, name).at(time));
  }
  CHECK(reusesStill(run.executor, "light"));
}

}  // namespace

TEST_CASE("after any sequence of times the octree is that of a fresh run at that time, to the bit") {
  for (const RoomLight& one : kRoomLights) {
    CAPTURE(one.name);
    checkAnySequence("voxel_cone_tracing_octree", movingRoom(one.light));
  }
}

TEST_CASE("after any sequence of times an octree of six faces is that of a fresh run, to the bit") {
  checkAnySequence("voxel_cone_tracing_octree_directional", movingRoom(lamp));
}

TEST_CASE("what stands still is built, lit and filtered once, and not where all of it is lit anew") {
  for (const bool lightMoves : {false, true}) {
    Scene scene = movingRoom(lamp);
    if (lightMoves)
      for (Object& object : scene.objects)
        if (object.animated())
          scene.materials[static_cast<std::size_t>(object.parts[0].material)].emission = glm::vec3(1.0f);
    Run run(scene);
    for (int frame = 0; frame < 5; ++frame) run.at(0.1 * frame, frame);
    CAPTURE(lightMoves);
    CHECK(reusesStill(run.executor, "voxels"));
    CHECK(reusesStill(run.executor, "tree"));
    CHECK(reusesStill(run.executor, "light") == !lightMoves);
    CHECK(reusesStill(run.executor, "bricks") == !lightMoves);
  }
}
