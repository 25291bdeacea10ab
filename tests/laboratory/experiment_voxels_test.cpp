// Which voxels a pipeline gathers its light from, and how they are judged beside its errors.
#include <fmt/format.h>

#include "experiment/gathered_voxels.h"
#include "lumivox/base/file.h"
#include "lumivox/scene/scene.h"
#include "support/facts.h"
#include "support/techniques.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::experiment;

namespace {

constexpr int kPixels = 16;

const Scene& cornell() {
  static const Scene scene = loadScene(sourceDirectory() / "scenes/cornell.scene");
  return scene;
}

struct Judging {
  ReportOptions options;
  TimingContext context{device(), techniques(), cornell(), options, kPixels, kPixels};
  VoxelReferences references{cornell(), 0.0, "", kPixels, kPixels};

  static ReportPoint pointOf(const Pipeline& pipeline, const std::vector<std::string>& settings) {
    ReportPoint point;
    point.parameters = pipeline.settings(settings);
    return point;
  }
  /// "pass.port", or nothing.
  std::string outputOf(const Pipeline& pipeline, const std::vector<std::string>& settings = {}) {
    const auto output = gatheredVoxelsOf(context, pipeline, pointOf(pipeline, settings));
    return output ? output->pass + "." + output->port : std::string();
  }
  std::optional<GatheredVoxels> judged(const Pipeline& pipeline,
                                       const std::vector<std::string>& settings = {}) {
    ReportPoint point = pointOf(pipeline, settings);
    judgeVoxels(context, pipeline, references, point);
    return point.voxels;
  }
};

/// Light is gathered from bits; there is no list.
Pipeline bitsAlone() {
  return Pipeline::parse(
      "pipeline \"Bits\" {\n"
      "  pass gbuffer direct_lighting.gbuffer { }\n"
      "  pass bits voxelization.atlas_binary { resolution 16 }\n"
      "  pass gather near_field_voxels.gather { gbuffer gbuffer  bits bits.bits }\n"
      "  pass smooth image_filters.smooth { gbuffer gbuffer  occlusion gather.occlusion }\n"
      "  output ambient_occlusion smooth.occlusion\n}\n",
      "bits.pipeline");
}

}  // namespace

TEST_CASE("the voxels of a pipeline are the list of fragments nearest to its indirect light") {
  Judging judging;
  // Behind the reprojection, not the points that go into it.
  CHECK(judging.outputOf(pipeline("imperfect_volumes")) == "voxels.fragments");
  CHECK(judging.outputOf(pipeline("imperfect_volumes_visible")) == "voxels.fragments");
  CHECK(judging.outputOf(pipeline("imperfect_volumes_propagation")) == "voxels.fragments");
  CHECK(judging.outputOf(pipeline("voxel_cone_tracing")) == "voxels.fragments");
  CHECK(judging.outputOf(pipeline("near_field_voxels")) == "voxels.fragments");
  CHECK(judging.outputOf(pipeline("direct_lighting")).empty());
  CHECK(judging.outputOf(pipeline("screen_space")).empty());
}

TEST_CASE("a list that nothing of the indirect light reads is not judged") {
  Judging judging;
  const std::string text = readFile(sourceDirectory() / "scenes/pipelines/imperfect_volumes.pipeline");
  const auto without = [&](std::string part) {
    std::string changed = text;
    const std::size_t at = changed.find(part);
    REQUIRE(at != std::string::npos);
    changed.erase(at, part.size());
    return Pipeline::parse(changed, "changed.pipeline");
  };
  // Two lists side by side: the one that is read.
  std::string two = text;
  const std::string pass = "  pass average voxelization.average { fragments voxels.fragments }\n";
  two.insert(two.find(pass), "  pass other voxelization.conservative { resolution $resolution }\n");
  CHECK(judging.outputOf(Pipeline::parse(two, "two.pipeline")) == "voxels.fragments");
  // Without the output of indirect light the whole image still depends on it.
  CHECK(judging.outputOf(without("  output indirect_diffuse gather.diffuse\n")) == "voxels.fragments");
}

TEST_CASE("without a list the nearest grid that says which voxels are occupied is judged") {
  Judging judging;
  const Pipeline bits = bitsAlone();
  CHECK(judging.outputOf(bits) == "bits.bits");
  const GatheredVoxels voxels = judging.judged(bits).value();
  CHECK(voxels.kind == "BinaryGrid");
  CHECK(voxels.whyNot.empty());
  CHECK(voxels.error.recall() > 0.9);
}

TEST_CASE("recall of the points that light is gathered from grows with their density, as holes close") {
  Judging judging;
  double recall = -1.0, holes = 2.0;
  for (const double density : {0.25, 1.0, 4.0, 16.0}) {
    const GatheredVoxels voxels =
        judging.judged(pipeline("imperfect_volumes"), {"resolution=16", fmt::format("density={}", density)})
            .value();
    INFO(density << ": recall " << voxels.error.recall() << ", holes " << voxels.holes.axisShare());
    CHECK(voxels.whyNot.empty());
    CHECK(voxels.output == "voxels.fragments");
    CHECK(voxels.kind == "VoxelFragments");
    CHECK(voxels.resolution.x <= 16);
    CHECK(voxels.error.recall() > recall);
    CHECK(voxels.holes.axisShare() < holes);
    recall = voxels.error.recall();
    holes = voxels.holes.axisShare();
  }
  CHECK(recall > 0.99);
  CHECK(holes < 0.01);
}

TEST_CASE("what the camera sees goes into the recall of a volume of visible surfaces, and no more") {
  Judging judging;
  const GatheredVoxels visible =
      judging.judged(pipeline("imperfect_volumes_visible"), {"resolution=16"}).value();
  CHECK(visible.error.recall() > 0.05);
  CHECK(visible.error.recall() < 0.9);
  CHECK(visible.error.precision() > 0.99);
}

TEST_CASE("the exact voxels of a grid are made once") {
  Judging judging;
  const GridPlacement one{{0, 0, 0}, 0.1f, {4, 4, 4}}, other{{0, 0, 0}, 0.05f, {8, 8, 8}};
  const VoxelReferences::InGrid* first = &judging.references.in(one);
  const VoxelReferences::InGrid* second = &judging.references.in(other);
  CHECK(first != second);
  CHECK(&judging.references.in(one) == first);
  CHECK(&judging.references.in(other) == second);
  CHECK(first->voxels.certain.resolution() == glm::ivec3(4));
}

TEST_CASE("voxels of a grid that is too fine are not judged, and say so") {
  Judging judging;
  const GatheredVoxels voxels =
      judging.judged(pipeline("imperfect_volumes_visible"), {"resolution=512"}).value();
  CHECK(voxels.output == "voxels.fragments");
  CHECK_THAT(voxels.whyNot, Tells("512 voxels along a side"));
  CHECK_THAT(voxels.whyNot, Tells("up to 256"));
  CHECK(voxels.occupied == 0);
}
