// How many fragments, slots and layers there are is found by the device and stays there: no pass waits for
// it, and a frame whose guess was too small is never given out.
#include <cmath>

#include "lumivox/pipeline/pass.h"
#include "support/scene_builder.h"
#include "support/techniques.h"
#include "support/voxel_fragments.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

constexpr int kSide = 32;  // voxels of a grid of 1.6 m around the camera at the origin
const std::string kGrid = "resolution 32 around camera extent 1.6";

/// A box of one mesh: each corner is there once.
void addBlock(Scene& scene, int material, const glm::vec3& low, const glm::vec3& high) {
  Object object;
  object.name = "block";
  object.firstVertex = static_cast<std::uint32_t>(scene.positions.size());
  object.vertexCount = 8;
  for (int k = 0; k < 8; ++k) {
    scene.positions.emplace_back((k & 1) != 0 ? high.x : low.x, (k & 2) != 0 ? high.y : low.y,
                                 (k & 4) != 0 ? high.z : low.z);
    scene.normals.emplace_back(0, 1, 0);
    scene.texcoords.emplace_back(0.0f);
  }
  constexpr std::uint32_t kCorners[] = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                        2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
  object.parts.push_back({material, static_cast<std::uint32_t>(scene.indices.size()),
                          static_cast<std::uint32_t>(std::size(kCorners))});
  for (const std::uint32_t corner : kCorners) scene.indices.push_back(object.firstVertex + corner);
  scene.objects.push_back(object);
}

/// Sixty plates, one above the other, and a closed block beside them travel along x: at time 0 they are far
/// outside of the grid, at time 1 the plates fill it, at time 2 the block does.
Scene travellers() {
  SceneBuilder builder;
  const int grey = builder.lambert(0.5f), areaLight = builder.lambert(0.25f, 3.0f);
  const auto move = [&](std::size_t first) {
    for (std::size_t o = first; o < builder.scene.objects.size(); ++o)
      builder.scene.objects[o].motion = RigidMotion{{0, 1, 0}, 0.0, {0, 0, 0}, {10, 0, 0}};
  };
  for (int i = 0; i < 60; ++i)
    builder.quad({-10.75f, -0.75f, -0.74f + 0.025f * static_cast<float>(i)}, {1.5f, 0, 0}, {0, 1.5f, 0},
                 i % 2 == 0 ? grey : areaLight);
  addBlock(builder.scene, grey, {-20.75f, -0.75f, -0.75f}, {-19.25f, 0.75f, 0.75f});
  move(0);
  builder.quad({0, 0, 0}, {0.2f, 0, 0}, {0, 0.2f, 0}, grey);  // stands still
  builder.look({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 0.7, 8, 8);
  return builder.scene;
}

const Pipeline& everyCount() {
  static const Pipeline text = Pipeline::parse(
      "pipeline \"counts\" {\n"
      "  pass touched voxelization.conservative { " +
          kGrid +
          " }\n"
          "  pass peeled voxelization.depth_peeling { " +
          kGrid +
          " }\n"
          "  pass solid voxelization.solid { fragments touched.fragments }\n"
          "  pass means voxelization.average { fragments touched.fragments }\n}\n",
      "made_by_a_test.pipeline");
  return text;
}

struct Run {
  Run() : scene(travellers()), executor(device(), techniques(), scene, everyCount(), {}) {
    for (const char* pass : {"touched", "peeled", "solid"}) executor.keepOutput(pass, "fragments");
    executor.keepOutput("means", "attributes");
    executor.keepOutput("means", "opacity");
  }
  void at(double time, int frame) { executor.render(time, frame, PipelineExecutor::Images::no); }
  std::vector<FragmentData> fragments(const char* pass) const {
    return voxelsOf(static_cast<const Out<VoxelFragments>*>(executor.output(pass, "fragments"))->value())
        .fragments;
  }
  const AttributeGrid& means() const {
    return static_cast<const Out<AttributeGrid>*>(executor.output("means", "attributes"))->value();
  }
  std::vector<float> opacity() const {
    return static_cast<const Out<OccupancyGrid>*>(executor.output("means", "opacity"))
        ->value()
        .opacity->downloadFloats();
  }
  Scene scene;
  PipelineExecutor executor;
};

}  // namespace

TEST_CASE(
    "counts that grow in the middle of a sequence leave no frame that differs from the same frame alone") {
  Run sequence;
  std::size_t least = ~std::size_t{0}, most = 0;
  int frame = 0;
  for (const double time : {0.0, 1.0, 1.05, 2.0, 0.0, 1.0}) {
    INFO("time " << time);
    sequence.at(time, frame);
    Run alone;
    alone.at(time, frame++);
    for (const char* pass : {"touched", "peeled", "solid"}) {
      INFO(pass);
      CHECK(sequence.fragments(pass) == alone.fragments(pass));
    }
    CHECK(sequence.means().albedo->downloadFloats() == alone.means().albedo->downloadFloats());
    CHECK(sequence.means().normal->downloadFloats() == alone.means().normal->downloadFloats());
    CHECK(sequence.means().emission->downloadFloats() == alone.means().emission->downloadFloats());
    CHECK(sequence.opacity() == alone.opacity());
    least = std::min(least, sequence.fragments("touched").size());
    most = std::max(most, sequence.fragments("touched").size());
  }
  // More than the first guess of 12 sides of the grid and 4 voxels a triangle has room for.
  CHECK(least < 200);
  CHECK(most > 12u * kSide * kSide + 4u * 140u);
}

TEST_CASE(
    "every layer, slot and solid voxel is there in the first frame, however wrong the first guess was") {
  Run run;
  run.at(1.0, 0);
  // 1.5 m of 5 cm voxels are 30 voxels along a side; seen along z all 60 plates are layers. From the sides no
  // centre of a pixel meets a plate without thickness, but for none: 60 x 30 x 30 pixels, and the small
  // square.
  CHECK(run.fragments("peeled").size() >= 60u * 30u * 30u);
  run.at(2.0, 1);
  // The block's surface lies on the faces of voxels, at 1 and 31, and touches the voxels at both sides: 28^3
  // of those inside are not touched, less those of the square that stands still, which touches both sides of
  // the faces around its 4 x 4 voxels: 6 x 6 x 2. The other fragments are those of the surface.
  CHECK(run.fragments("solid").size() == run.fragments("touched").size() + 28u * 28u * 28u - 72u);
}

TEST_CASE("in a steady frame no pass of a voxelizer waits for the device") {
  Run run;
  int frame = 0;
  for (const double time : {1.0, 1.01, 1.02}) run.at(time, frame++);
  const std::uint64_t before = device().transfers().stalls;
  const FrameResult steady = run.executor.render(1.03, frame, PipelineExecutor::Images::no);
  CHECK(device().transfers().stalls == before);
  for (const PassRecord& pass : steady.passes) CHECK(pass.ran);
  // The counter does count: a download with work under way waits for it.
  const VoxelFragments& list =
      static_cast<const Out<VoxelFragments>*>(run.executor.output("touched", "fragments"))->value();
  list.count->download();
  CHECK(device().transfers().stalls == before);
  PassHarness harness(device(), techniques(), "voxelization", "conservative", run.scene,
                      snapshotOf(run.scene, 1.0));
  PassContext& context = harness.context();
  context.dispatch(context.program({"voxelization", "copy_count"}),
                   {gpu::ResourceBinding{"From", 0, gpu::ResourceBinding::Storage{list.count.get()}},
                    gpu::ResourceBinding{"To", 1, gpu::ResourceBinding::Storage{list.count.get()}}},
                   {1, 1, 1});
  list.count->download();
  CHECK(device().transfers().stalls == before + 1);
}

TEST_CASE("a list from nothing of static geometry is as long as it has to be") {
  Scene scene = litRoom(8, 8);
  const Pipeline text =
      Pipeline::parse("pipeline \"still\" {\n  pass voxels voxelization.conservative { resolution 24 }\n}\n",
                      "made_by_a_test.pipeline");
  PipelineExecutor executor(device(), techniques(), scene, text, {});
  executor.keepOutput("voxels", "fragments");
  const auto list = [&] {
    executor.invalidate();
    executor.render(0.0, 0, PipelineExecutor::Images::no);
    return static_cast<const Out<VoxelFragments>*>(executor.output("voxels", "fragments"))->value();
  };
  const std::vector<FragmentData> first = fragmentsOf(list());
  const VoxelFragments second = list();
  CHECK(second.capacity == first.size());
  CHECK(fragmentsOf(second) == first);
}
