// Common behaviour of all voxelizers: static geometry is voxelized once, moving geometry in every frame, and
// no frame can be told from the first one of a fresh run.
#include <cmath>
#include <cstring>

#include "lumivox/pipeline/pass.h"
#include "support/scene_builder.h"
#include "support/techniques.h"
#include "support/voxel_fragments.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

Pipeline oneVoxelizer(const std::string& parameters) {
  return Pipeline::parse(
      "pipeline \"voxels\" {\n  pass gbuffer direct_lighting.gbuffer { }\n"
      "  pass shadow direct_lighting.shadow_map { size 16 }\n"
      "  pass voxels voxelization.conservative { " +
          parameters +
          " }\n"
          "  pass light voxel_cone_tracing.inject { fragments voxels.fragments  shadow shadow.depth }\n"
          "  pass grid voxel_cone_tracing.filter { radiance light.radiance }\n"
          "  pass gather voxel_cone_tracing.gather { gbuffer gbuffer  grid grid.mips  cones 1 }\n"
          "  output diffuse gather.diffuse\n}\n",
      "made_by_a_test.pipeline");
}

RenderOptions small() {
  RenderOptions options;
  options.width = options.height = 8;
  return options;
}

/// A pipeline of one voxelizer whose fragments stay readable.
struct Run {
  Run(const Scene& scene, const std::string& parameters, RenderOptions options = small())
      : executor(device(), techniques(), scene, oneVoxelizer(parameters), options) {
    executor.keepOutput("voxels", "fragments");
  }
  Voxels at(double time, int frame = 0) { return now(executor.render(time, frame)); }
  Voxels now(const FrameResult&) {
    const auto* output = static_cast<const Out<VoxelFragments>*>(executor.output("voxels", "fragments"));
    REQUIRE(output != nullptr);
    return voxelsOf(output->value());
  }
  bool reusesStaticGeometry() const {
    const std::vector<LeftOut> leftOut = executor.explain().leftOut;
    return std::any_of(leftOut.begin(), leftOut.end(), [](const LeftOut& one) {
      return one.level == LeftOut::Level::time && one.pass == "voxels" &&
             one.what.find("static geometry") != std::string::npos;
    });
  }
  PipelineExecutor executor;
};

/// A room with boxes; one box turns and travels, a plate only travels.
Scene movingRoom(const glm::dvec3& velocity = {0.1, 0, 0.05}) {
  Scene scene = litRoom(8, 8);
  SceneBuilder builder;
  builder.scene = scene;
  const int grey = builder.lambert(0.5f);
  const std::size_t first = builder.scene.objects.size();
  builder.box({0.4f, 0.6f, 0.4f}, {0.6f, 0.8f, 0.6f}, grey, false);
  for (std::size_t o = first; o < builder.scene.objects.size(); ++o)
    builder.scene.objects[o].motion = RigidMotion{{0, 1, 0.2}, 0.7, {0.5, 0.7, 0.5}, {0, 0, 0}};
  builder.quad({0.1f, 0.3f, 0.7f}, {0.2f, 0, 0}, {0, 0.2f, 0.1f}, grey).motion =
      RigidMotion{{0, 1, 0}, 0.0, {0, 0, 0}, velocity};
  return builder.scene;
}

void checkSame(const Voxels& a, const Voxels& b) {
  CHECK(a.grid == b.grid);
  CHECK(a.occupied == b.occupied);
  CHECK(a.fragments.size() == b.fragments.size());
  CHECK(a.fragments == b.fragments);
}

}  // namespace

TEST_CASE("after any sequence of times the fragments are those of a fresh run at that time") {
  const Scene scene = movingRoom();
  Run run(scene, "resolution 24");
  int frame = 0;
  std::size_t changed = 0;
  Voxels before = run.at(0.0, frame++);
  CHECK_FALSE(run.reusesStaticGeometry());
  // Forwards, backwards, the same time again, a teleport and a time in the far future.
  for (const double time : {0.1, 0.2, 0.15, 0.15, 3.0, 0.0, 1e6}) {
    INFO("time " << time);
    const Voxels voxels = run.at(time, frame++);
    checkSame(voxels, Run(scene, "resolution 24").at(time));
    changed += voxels.fragments != before.fragments;
    before = voxels;
  }
  CHECK(changed == 6);
  CHECK(run.reusesStaticGeometry());
}

TEST_CASE("the fragments of still geometry stay at the beginning of the list, untouched") {
  const Scene scene = movingRoom({0, 0, 0});
  Run run(scene, "resolution 24");
  const auto raw = [&](double time) {
    run.executor.render(time);
    const auto* output = static_cast<const Out<VoxelFragments>*>(run.executor.output("voxels", "fragments"));
    return output->value().fragments->downloadValues<FragmentData>();
  };
  Scene still = scene;
  std::erase_if(still.objects, [](const Object& object) { return object.animated(); });
  const std::size_t stillCount = Run(still, "resolution 24").at(0.0).fragments.size();
  const auto first = raw(0.0), second = raw(0.5);
  REQUIRE(stillCount > 1000);
  // On one device a second voxelization may write in the same order, so that the explanation has to say it
  // too.
  CHECK(std::equal(first.begin(), first.begin() + static_cast<std::ptrdiff_t>(stillCount), second.begin()));
  CHECK(run.reusesStaticGeometry());
}

TEST_CASE("a list tells its first fragments, of what stands still, from those behind, and keeps its proof") {
  const Scene scene = movingRoom();
  Run run(scene, "resolution 24");
  const auto listAt = [&](double time) {
    run.executor.render(time);
    return static_cast<const Out<VoxelFragments>*>(run.executor.output("voxels", "fragments"))->value();
  };
  listAt(0.0);
  const VoxelFragments first = listAt(0.1), second = listAt(0.2);
  Scene still = scene;
  std::erase_if(still.objects, [](const Object& object) { return object.animated(); });
  const auto words = [](const gpu::BufferRef& buffer) { return buffer->downloadValues<std::uint32_t>(); };
  REQUIRE(second.still != nullptr);
  CHECK(first.still == second.still);
  CHECK(words(second.still)[0] == Run(still, "resolution 24").at(0.0).fragments.size());
  CHECK(words(second.still)[0] + words(second.moving)[0] == words(second.count)[0]);
  CHECK(words(second.moving)[0] > 0);
  // Dispatches over both.
  CHECK(words(second.still)[1] == (words(second.still)[0] + 63) / 64);
  CHECK(words(second.moving)[1] == (words(second.moving)[0] + 63) / 64);
}

TEST_CASE("without anything that stands still, and without anything that moves, the list is right as well") {
  Scene moving = movingRoom();
  std::erase_if(moving.objects, [](const Object& object) { return !object.animated(); });
  Run run(moving, "resolution 16");
  run.at(0.0);
  checkSame(run.at(0.4, 1), Run(moving, "resolution 16").at(0.4));
  CHECK_FALSE(run.reusesStaticGeometry());

  Scene still = movingRoom();
  std::erase_if(still.objects, [](const Object& object) { return object.animated(); });
  Run resting(still, "resolution 16");
  const Voxels first = resting.at(0.0);
  checkSame(resting.at(1.0, 1), first);
}

TEST_CASE("a list grows while things move and nothing is lost") {
  // A mesh of many small triangles that a moving scale spreads over more and more voxels: a deforming object.
  SceneBuilder builder;
  const int grey = builder.lambert(0.5f);
  builder.box({-1, -1, -1}, {1, 1, 1}, grey, false);
  constexpr int kQuads = 700;
  Object& swarm = builder.quad({0, 0, 0}, {0.01f, 0, 0}, {0, 0.01f, 0}, grey);
  Scene& scene = builder.scene;
  for (int i = 1; i < kQuads; ++i) {
    const auto base = static_cast<std::uint32_t>(scene.positions.size());
    for (int k = 0; k < 4; ++k) {
      scene.positions.push_back(scene.positions[swarm.firstVertex + static_cast<std::uint32_t>(k)]);
      scene.normals.emplace_back(0, 0, 1);
      scene.texcoords.emplace_back(0, 0);
    }
    for (const std::uint32_t index : {0u, 1u, 2u, 0u, 2u, 3u}) scene.indices.push_back(base + index);
  }
  swarm.vertexCount = 4 * kQuads;
  swarm.parts.front().indexCount = 6 * kQuads;
  VertexSequence sequence;
  sequence.framesPerSecond = 1.0;
  for (const float scale : {1.0f, 90.0f}) {
    sequence.positions.emplace_back();
    for (std::uint32_t v = 0; v < swarm.vertexCount; ++v)
      sequence.positions.back().push_back(scale * scene.positions[swarm.firstVertex + v] - glm::vec3(0.45f));
    sequence.normals.emplace_back(swarm.vertexCount, glm::vec3(0, 0, 1));
  }
  swarm.sequence = sequence;
  const std::string resolution = "resolution 10";
  Run run(scene, resolution);
  const std::size_t few = run.at(0.0).fragments.size();
  const Voxels many = run.at(1.0, 1);
  INFO("fragments " << few << " and then " << many.fragments.size());
  // More than the first guess of 12 voxels per square of the side and 4 per triangle.
  REQUIRE(many.fragments.size() > 12u * 100u + 4u * (2u * kQuads + 12u));
  checkSame(many, Run(scene, resolution).at(1.0));
  checkSame(run.at(0.0, 2), Run(scene, resolution).at(0.0));
}

TEST_CASE("invalidate and keep-everything voxelize static geometry anew, with the same fragments") {
  const Scene scene = movingRoom();
  Run run(scene, "resolution 16");
  run.at(0.0);
  run.executor.invalidate();
  const Voxels anew = run.at(0.3, 1);
  CHECK_FALSE(run.reusesStaticGeometry());
  RenderOptions everything = small();
  everything.keepEverything = true;
  Run whole(scene, "resolution 16", everything);
  whole.at(0.0);
  checkSame(whole.at(0.3, 1), anew);
  CHECK_FALSE(whole.reusesStaticGeometry());
}

TEST_CASE("a grid around the camera moves by whole voxels and keeps its fragments between such steps") {
  Scene scene = movingRoom();
  // Voxels of 0.1 m; 0.13 m in 1 s.
  scene.cameras.front().keys = {{0.0, {0.5, 0.5, 0.5}, {0.5, 0.5, 0.0}},
                                {1.0, {0.63, 0.5, 0.5}, {0.63, 0.5, 0.0}}};
  const std::string parameters = "resolution 8  around camera  extent 0.8 m";
  Run run(scene, parameters);
  const Voxels first = run.at(0.0);
  CHECK(first.grid.resolution == glm::ivec3(8));
  CHECK(first.grid.voxelSize == Approx(0.1f));
  int steps = 0;
  GridPlacement before = first.grid;
  for (int i = 1; i <= 10; ++i) {
    const double time = 0.1 * i;
    const Voxels voxels = run.at(time, i);
    checkSame(voxels, Run(scene, parameters).at(time));
    const float moved = (voxels.grid.low.x - before.low.x) / 0.1f;
    CHECK(std::abs(moved - std::round(moved)) < 1e-4f);
    steps += voxels.grid == before ? 0 : 1;
    before = voxels.grid;
  }
  CHECK(steps >= 1);
  CHECK(steps <= 2);
  CHECK(run.reusesStaticGeometry());
}

TEST_CASE("a grid around the camera needs an extent") {
  Scene scene = movingRoom();
  const std::string message = messageOf<std::exception>([&] { Run(scene, "around camera").at(0.0); });
  CHECK_THAT(message, Catch::Matchers::Contains("extent above 0 m"));
}

TEST_CASE("a still object that is moved by hand is voxelized where it stands") {
  const Scene scene = movingRoom();
  RenderOptions options = small();
  options.interactive = true;
  Run run(scene, "resolution 16", options);
  run.at(0.0);
  SceneSnapshot snapshot = snapshotOf(scene, 0.0, {}, 8, 8);
  snapshot.objects[7].toWorld[3] += glm::vec4(0.05f, 0.1f, 0.02f, 0.0f);
  const Voxels moved = run.now(run.executor.render(snapshot, 1));
  Run fresh(scene, "resolution 16", options);
  checkSame(moved, fresh.now(fresh.executor.render(snapshot, 0)));
}

TEST_CASE(
    "bits are made anew only where something moves or moved, and are those of a fresh run at every level") {
  const Scene scene = movingRoom({0.3, 0.2, 0.1});
  const auto bitsOf = [](const PipelineExecutor& executor) {
    return static_cast<const Out<BinaryGrid>*>(executor.output("bits", "bits"))->value();
  };
  const auto texelsOf = [](const BinaryGrid& grid) {
    std::vector<std::vector<std::byte>> levels;
    for (int level = 0; level < grid.stacks->description().levels; ++level)
      levels.push_back(grid.stacks->download(level));
    return levels;
  };
  for (const char* masks : {"any", "half", "random"}) {
    const Pipeline text = Pipeline::parse(
        std::string("pipeline \"bits\" {\n  pass gbuffer direct_lighting.gbuffer { }\n"
                    "  pass voxels voxelization.conservative { resolution 37 }\n"
                    "  pass bits voxelization.average { fragments voxels.fragments  masks ") +
            masks +
            " }\n  pass gather near_field_voxels.gather { gbuffer gbuffer  bits bits.bits  rays 1 }\n"
            "  output open gather.occlusion\n}\n",
        "made_by_a_test.pipeline");
    const auto start = [&] {
      auto executor = std::make_unique<PipelineExecutor>(device(), techniques(), scene, text, small());
      executor->keepOutput("bits", "bits");
      return executor;
    };
    const auto sequence = start();
    const gpu::Texture* kept = nullptr;
    std::vector<std::vector<std::byte>> before;
    int frame = 0, changed = 0;
    for (const double time : {0.0, 0.3, 0.35, 1.0, 0.0, 0.0, 0.6}) {
      sequence->render(time, frame++);
      const auto fresh = start();
      fresh->render(time);
      const BinaryGrid grid = bitsOf(*sequence);
      const auto texels = texelsOf(grid);
      CAPTURE(masks, frame);
      CHECK(texels == texelsOf(bitsOf(*fresh)));
      // The same texture from the second frame on: nothing of what stands still was made again.
      if (frame > 2) CHECK(grid.stacks.get() == kept);
      kept = grid.stacks.get();
      changed += texels != before;
      before = texels;
    }
    CHECK(changed >= 5);
  }
}
