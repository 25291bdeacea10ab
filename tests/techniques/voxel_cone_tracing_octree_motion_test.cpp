// What moves changes only a part of the octree: the rest is kept, and nothing tells a frame from the first
// one of a fresh run.
#include "support/octree.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::octree;

namespace {

/// A room in which a box turns and a plate travels between the lights and the floor.
Scene movingRoom(const std::function<void(SceneBuilder&)>& light) {
  SceneBuilder builder;
  const int grey = builder.lambert(0.5f);
  builder.box({-1, -1, -1}, {1, 1, 1}, grey, false);
  builder.box({-0.8f, -1.0f, -0.6f}, {-0.4f, -0.3f, -0.2f}, grey, false);
  const std::size_t first = builder.scene.objects.size();
  builder.box({0.3f, -0.6f, 0.3f}, {0.5f, -0.4f, 0.5f}, grey, false);
  for (std::size_t o = first; o < builder.scene.objects.size(); ++o)
    builder.scene.objects[o].motion = RigidMotion{{0, 1, 0.2}, 0.7, {0.4, -0.5, 0.4}, {0, 0, 0}};
  builder.quad({-0.6f, 0.2f, 0.1f}, {0.3f, 0, 0}, {0, 0.1f, 0.3f}, grey).motion =
      RigidMotion{{0, 1, 0}, 0.0, {0, 0, 0}, {0.1, 0, 0.05}};
  light(builder);
  builder.look({0, 0, 0.9}, {0, 0, 0}, {0, 1, 0}, 0.7, 8, 8);
  return builder.scene;
}

/// An octree of the room that stays readable.
struct Run {
  explicit Run(const Scene& scene, int resolution = 32)
      : executor(device(), techniques(), scene, pipeline("voxel_cone_tracing_octree"), options(resolution)) {
    executor.keepOutput("bricks", "mips");
  }
  static RenderOptions options(int resolution) {
    RenderOptions result;
    result.width = result.height = 8;
    result.parameters =
        pipeline("voxel_cone_tracing_octree").settings({"resolution=" + std::to_string(resolution)});
    return result;
  }
  const RadianceOctree& at(double time, int frame = 0) {
    executor.render(time, frame);
    return static_cast<const Out<RadianceOctree>*>(executor.output("bricks", "mips"))->value();
  }
  bool reuses(const std::string& pass) const {
    const std::vector<LeftOut> leftOut = executor.explain().leftOut;
    return std::any_of(leftOut.begin(), leftOut.end(), [&](const LeftOut& one) {
      return one.level == LeftOut::Level::time && one.pass == pass &&
             one.what.find("static geometry") != std::string::npos;
    });
  }
  PipelineExecutor executor;
};

void checkSame(const RadianceOctree& a, const RadianceOctree& b) {
  REQUIRE(a.tree.depth == b.tree.depth);
  CHECK(a.unit == b.unit);
  for (int level = 0; level <= a.tree.depth; ++level) {
    CAPTURE(level);
    const auto first = bricksOf(a, level), second = bricksOf(b, level);
    CHECK(!first.empty());
    CHECK((first == second));
  }
}

const glm::vec3 kSun = glm::normalize(glm::vec3(0.3f, -1.0f, 0.2f));

void sun(SceneBuilder& builder) {
  // Without the lid of the room.
  std::erase_if(builder.scene.objects, [&](const Object& object) {
    const auto first = builder.scene.positions.begin() + object.firstVertex;
    return std::all_of(first, first + object.vertexCount, [](const glm::vec3& at) { return at.y > 0.99f; });
  });
  builder.light(LightKind::directional, glm::vec3(3.0f), {0, 0, 0}, kSun);
}
void lamp(SceneBuilder& builder) {
  builder.light(LightKind::point, glm::vec3(1.0f), {0.1f, 0.8f, 0.0f}, {0, -1, 0});
}
void spot(SceneBuilder& builder) {
  builder.light(LightKind::spot, glm::vec3(1.0f), {-0.7f, 0.8f, 0.3f}, {0.5f, -1, 0});
}
void area(SceneBuilder& builder) {
  builder.quad({-0.2f, 0.95f, -0.2f}, {0.4f, 0, 0}, {0, 0, 0.4f}, builder.lambert(0.5f, 5.0f));
}

}  // namespace

TEST_CASE("after any sequence of times the octree is that of a fresh run at that time, to the bit") {
  struct Case {
    const char* name;
    void (*light)(SceneBuilder&);
  };
  for (const Case& one : {Case{"sun", sun}, Case{"lamp", lamp}, Case{"spot", spot}, Case{"area", area}}) {
    const Scene scene = movingRoom(one.light);
    Run run(scene);
    int frame = 0;
    // Forwards, backwards, the same time again, and a turn further.
    for (const double time : {0.0, 0.1, 0.2, 0.5, 0.3, 0.3, 3.0, 2.9}) {
      CAPTURE(one.name, time);
      checkSame(run.at(time, frame++), Run(scene).at(time));
    }
    CHECK(run.reuses("light"));
  }
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
    CHECK(run.reuses("voxels"));
    CHECK(run.reuses("tree"));
    CHECK(run.reuses("light") == !lightMoves);
    CHECK(run.reuses("bricks") == !lightMoves);
  }
}
