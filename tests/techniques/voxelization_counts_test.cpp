// How many fragments, slots and layers there are is found by the device and stays there: no pass waits for
// it, and a frame whose guess was too small is never given out.
#include <cmath>

#include "support/meshes.h"
#include "support/voxelizers.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

constexpr int kSide = 32;  // voxels of a grid of 1.6 m around the camera at the origin
const std::string kGrid = "resolution 32 around camera extent 1.6";

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
  addMesh(builder.scene, boxMesh({-20.75f, -0.75f, -0.75f}, {-19.25f, 0.75f, 0.75f}), grey);
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
    return voxelsOf(kept<VoxelFragments>(executor, pass, "fragments")).fragments;
  }
  const AttributeGrid& means() const { return kept<AttributeGrid>(executor, "means", "attributes"); }
  std::vector<float> opacity() const {
    return kept<OccupancyGrid>(executor, "means", "opacity").opacity->downloadFloats();
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
  const VoxelFragments& list = kept<VoxelFragments>(run.executor, "touched", "fragments");
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
  const Scene scene = litRoom(8, 8);
  VoxelizedFrames frames(scene, {"conservative"}, "resolution 24");
  const auto list = [&] {
    frames.executor.invalidate();
    frames.at(0.0);
    return frames.list();
  };
  const std::vector<FragmentData> first = fragmentsOf(list());
  const VoxelFragments second = list();
  CHECK(second.capacity == first.size());
  CHECK(fragmentsOf(second) == first);
}
