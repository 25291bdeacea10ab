// Common behaviour of all voxelizers: static geometry is voxelized once, moving geometry in every frame, and
// no frame can be told from the first one of a fresh run.
#include <cmath>

#include "support/voxelizers.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

/// A room with boxes; one box turns, a plate travels and a sheet deforms.
Scene movingRoom(const glm::dvec3& velocity = {0.1, 0, 0.05}) {
  SceneBuilder builder;
  builder.scene = litRoom(8, 8);
  const int grey = builder.lambert(0.5f);
  const std::size_t first = builder.scene.objects.size();
  builder.box({0.4f, 0.6f, 0.4f}, {0.6f, 0.8f, 0.6f}, grey, false);
  for (std::size_t o = first; o < builder.scene.objects.size(); ++o)
    builder.scene.objects[o].motion = RigidMotion{{0, 1, 0.2}, 0.7, {0.5, 0.7, 0.5}, {0, 0, 0}};
  builder.quad({0.1f, 0.3f, 0.7f}, {0.2f, 0, 0}, {0, 0.2f, 0.1f}, grey).motion =
      RigidMotion{{0, 1, 0}, 0.0, {0, 0, 0}, velocity};
  Object& sheet = builder.quad({0.2f, 0.9f, 0.2f}, {0, 0, 0.3f}, {0.3f, 0.02f, 0.05f}, grey);
  VertexSequence sequence;
  sequence.framesPerSecond = 1.0;
  for (const float height : {0.0f, 0.3f}) {
    sequence.positions.emplace_back(builder.scene.positions.end() - 4, builder.scene.positions.end());
    sequence.positions.back()[1].y -= height;
    sequence.normals.emplace_back(builder.scene.normals.end() - 4, builder.scene.normals.end());
  }
  sheet.sequence = sequence;
  return builder.scene;
}
/// What stands still in a scene, or what does not.
Scene partOf(Scene scene, bool animated) {
  std::erase_if(scene.objects, [=](const Object& object) { return object.animated() != animated; });
  return scene;
}

void checkSame(const Voxels& a, const Voxels& b) {
  CHECK(a.grid == b.grid);
  CHECK(a.fragments.size() == b.fragments.size());
  CHECK(a.fragments == b.fragments);
}

RenderOptions everything() {
  RenderOptions options;
  options.keepEverything = true;
  return options;
}

const Voxelizer kConservative{"conservative"};

}  // namespace

TEST_CASE("after any sequence of times the fragments are those of a fresh run, with everything kept too") {
  const Voxelizer by = GENERATE(from_range(kVoxelizers));
  INFO(by.name());
  const Scene scene = movingRoom();
  VoxelizedFrames frames(scene, by, "resolution 20");
  Voxels before = frames.at(0.0, 0);
  CHECK_FALSE(frames.reusesStill());
  CHECK(before.fragments.size() > 100);
  // Forwards, backwards, the same time again, a teleport and a time in the far future.
  int frame = 1;
  std::size_t changed = 0;
  for (const double time : {0.2, 0.15, 0.15, 3.0, 0.0, 1e6}) {
    INFO("time " << time);
    const Voxels voxels = frames.at(time, frame++);
    checkSame(voxels, VoxelizedFrames(scene, by, "resolution 20").at(time));
    changed += voxels.fragments != before.fragments;
    before = voxels;
  }
  CHECK(changed == 5);
  CHECK(frames.reusesStill());
  VoxelizedFrames anew(scene, by, "resolution 20");
  anew.at(0.0);
  anew.executor.invalidate();
  checkSame(anew.at(1e6, 1), before);
  CHECK_FALSE(anew.reusesStill());
  VoxelizedFrames whole(scene, by, "resolution 20", everything());
  whole.at(0.0);
  checkSame(whole.at(1e6, 1), before);
  CHECK_FALSE(whole.reusesStill());
}

TEST_CASE(
    "the fragments of still geometry stay at the beginning of the list, untouched, and keep their proof") {
  const Scene scene = movingRoom();
  const std::size_t still =
      VoxelizedFrames(partOf(scene, false), kConservative, "resolution 24").at(0.0).fragments.size();
  REQUIRE(still > 1000);
  VoxelizedFrames frames(scene, kConservative, "resolution 24");
  const auto listAt = [&](double time) {
    frames.at(time);
    return frames.list();
  };
  listAt(0.0);
  const VoxelFragments first = listAt(0.1);
  const auto words = [](const gpu::BufferRef& buffer) { return buffer->downloadValues<std::uint32_t>(); };
  const auto of = [](const VoxelFragments& list) { return list.fragments->downloadValues<FragmentData>(); };
  const std::vector<FragmentData> before = of(first);
  const VoxelFragments second = listAt(0.2);
  const std::vector<FragmentData> after = of(second);
  // On one device a second voxelization may write in the same order: the explanation has to say it too.
  CHECK(std::equal(before.begin(), before.begin() + static_cast<std::ptrdiff_t>(still), after.begin()));
  CHECK(frames.reusesStill());
  REQUIRE(second.still != nullptr);
  CHECK(first.still == second.still);
  CHECK(words(second.still)[0] == still);
  CHECK(words(second.still)[0] + words(second.moving)[0] == words(second.count)[0]);
  CHECK(words(second.moving)[0] > 0);
  // Dispatches over both.
  CHECK(words(second.still)[1] == (words(second.still)[0] + 63) / 64);
  CHECK(words(second.moving)[1] == (words(second.moving)[0] + 63) / 64);
}

TEST_CASE("without anything that stands still, and without anything that moves, the list is right as well") {
  const Scene moving = partOf(movingRoom(), true), still = partOf(movingRoom(), false);
  VoxelizedFrames frames(moving, kConservative, "resolution 16");
  frames.at(0.0);
  checkSame(frames.at(0.4, 1), VoxelizedFrames(moving, kConservative, "resolution 16").at(0.4));
  CHECK_FALSE(frames.reusesStill());
  VoxelizedFrames resting(still, kConservative, "resolution 16");
  const Voxels first = resting.at(0.0);
  checkSame(resting.at(1.0, 1), first);
}

TEST_CASE("a list grows while things move and nothing is lost") {
  // A mesh of many small triangles that a moving scale spreads over more and more voxels: a deforming object.
  SceneBuilder builder;
  const int grey = builder.lambert(0.5f);
  builder.box({-1, -1, -1}, {1, 1, 1}, grey, false);
  constexpr int kTriangles = 1400;
  std::vector<glm::vec3> corners;
  for (int i = 0; i < kTriangles; ++i) corners.insert(corners.end(), {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}});
  Object& swarm = builder.mesh(corners, grey);
  VertexSequence sequence;
  sequence.framesPerSecond = 1.0;
  for (const float scale : {0.01f, 0.9f}) {
    std::vector<glm::vec3> places;
    for (const glm::vec3& corner : corners) places.push_back(scale * corner - glm::vec3(0.45f));
    sequence.positions.push_back(places);
    sequence.normals.emplace_back(corners.size(), glm::vec3(0, 0, 1));
  }
  swarm.sequence = sequence;
  VoxelizedFrames frames(builder.scene, kConservative, "resolution 10");
  const Voxels few = frames.at(0.0), many = frames.at(1.0, 1);
  // More than the first guess of 12 voxels per square of the side and 4 per triangle.
  REQUIRE(many.fragments.size() > 12u * 100u + 4u * (kTriangles + 12u));
  checkSame(many, VoxelizedFrames(builder.scene, kConservative, "resolution 10").at(1.0));
  checkSame(frames.at(0.0, 2), few);
}

TEST_CASE("a grid around the camera moves by whole voxels and keeps its fragments between such steps") {
  const Voxelizer by = GENERATE(from_range(kVoxelizers));
  INFO(by.name());
  Scene scene = movingRoom();
  // Voxels of 0.1 m; 0.13 m in 1 s.
  scene.cameras.front().keys = {{0.0, {0.5, 0.5, 0.5}, {0.5, 0.5, 0.0}},
                                {1.0, {0.63, 0.5, 0.5}, {0.63, 0.5, 0.0}}};
  const std::string words = "resolution 8  around camera  extent 0.8 m";
  VoxelizedFrames frames(scene, by, words);
  GridPlacement before = frames.at(0.0).grid;
  CHECK(before.resolution == glm::ivec3(8));
  CHECK(before.voxelSize == Approx(0.1f));
  int steps = 0;
  for (int i = 1; i <= 5; ++i) {
    const Voxels voxels = frames.at(0.2 * i, i);
    checkSame(voxels, VoxelizedFrames(scene, by, words).at(0.2 * i));
    const float moved = (voxels.grid.low.x - before.low.x) / 0.1f;
    CHECK(std::abs(moved - std::round(moved)) < 1e-4f);
    steps += voxels.grid == before ? 0 : 1;
    before = voxels.grid;
  }
  CHECK(steps >= 1);
  CHECK(steps <= 2);
  CHECK_THROWS_WITH(VoxelizedFrames(scene, by, "around camera").at(0.0), Catch::Contains("extent"));
}

TEST_CASE("a still object that is moved by hand is voxelized where it stands") {
  const Scene scene = movingRoom();
  RenderOptions options;
  options.interactive = true;
  SceneSnapshot snapshot = snapshotOf(scene, 0.0, {}, 8, 8);
  snapshot.objects[7].toWorld[3] += glm::vec4(0.05f, 0.1f, 0.02f, 0.0f);
  VoxelizedFrames frames(scene, kConservative, "resolution 16", options),
      fresh(scene, kConservative, "resolution 16", options);
  frames.at(0.0);
  for (VoxelizedFrames* one : {&frames, &fresh})
    one->executor.render(snapshot, 1, PipelineExecutor::Images::no);
  checkSame(voxelsOf(frames.list()), voxelsOf(fresh.list()));
}

TEST_CASE(
    "bits are made anew only where something moves or moved, and are those of a fresh run at every level") {
  const Scene scene = movingRoom({0.3, 0.2, 0.1});
  for (const std::string masks : {"any", "half", "random"}) {
    const Pipeline text = Pipeline::parse(
        "pipeline \"bits\" {\n  pass voxels voxelization.conservative { resolution 37 }\n"
        "  pass bits voxelization.average { fragments voxels.fragments  masks " +
            masks + " }\n}\n",
        "made_by_a_test.pipeline");
    struct Frames {
      PipelineExecutor executor;
      Frames(const Scene& shown, const Pipeline& pipeline)
          : executor(device(), techniques(), shown, pipeline, {}) {
        executor.keepOutput("bits", "bits");
      }
      std::vector<std::vector<std::byte>> at(double time, int frame = 0) {
        executor.render(time, frame, PipelineExecutor::Images::no);
        std::vector<std::vector<std::byte>> levels;
        for (int level = 0; level < texture()->description().levels; ++level)
          levels.push_back(texture()->download(level));
        return levels;
      }
      const gpu::Texture* texture() const { return kept<BinaryGrid>(executor, "bits", "bits").stacks.get(); }
    } sequence(scene, text);
    const gpu::Texture* stacks = nullptr;
    std::vector<std::vector<std::byte>> before;
    int frame = 0, changed = 0;
    for (const double time : {0.0, 0.3, 0.35, 1.0, 0.0, 0.0, 0.6}) {
      const auto texels = sequence.at(time, frame++);
      CAPTURE(masks, frame);
      CHECK(texels == Frames(scene, text).at(time));
      // The same texture from the second frame on: nothing of what stands still was made again.
      if (frame > 2) CHECK(sequence.texture() == stacks);
      stacks = sequence.texture();
      changed += texels != before;
      before = texels;
    }
    CHECK(changed >= 5);
  }
}
