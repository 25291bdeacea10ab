// Cones that are not the gather's through an octree: to lights, and through a lens.
#include "lumivox/base/file.h"
#include "lumivox/measure/metrics.h"
#include "support/techniques.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

/// A committed pipeline that reads the dense grid, with the octree in place of it.
Pipeline throughOctree(const std::string& name) {
  std::string text = readFile(sourceDirectory() / ("scenes/pipelines/" + name + ".pipeline"));
  const auto replace = [&](const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    REQUIRE(at != std::string::npos);
    text.replace(at, from.size(), to);
  };
  const std::size_t inject = text.find("voxel_cone_tracing.inject ");
  REQUIRE(inject != std::string::npos);
  text.replace(inject, std::string("voxel_cone_tracing.inject {").size(),
               "voxel_cone_tracing.octree_inject { tree tree.tree ");
  replace("voxel_cone_tracing.filter ", "voxel_cone_tracing.octree_filter ");
  replace("grid grid.mips", "octree grid.mips");
  const std::size_t voxels = text.find('\n', text.find("voxelization.conservative"));
  text.insert(voxels, "\n  pass tree voxel_cone_tracing.octree { fragments voxels.fragments }");
  return Pipeline::parse(text, "through_octree.pipeline");
}

ImageBuffer rendered(const Pipeline& text, const std::string& output) {
  RenderOptions options;
  options.width = options.height = 48;
  options.parameters = text.settings({"resolution=32"});
  const Scene scene = loadScene(sourceDirectory() / "scenes/cornell.scene");
  return renderOnce(scene, text, options).outputs.at(output);
}

}  // namespace

TEST_CASE("cones to lights and through a lens see the same voxels in an octree") {
  struct Row {
    const char* pipeline;
    const char* output;
  };
  for (const Row& row : {Row{"voxel_cone_tracing_soft_shadows", "direct"},
                         Row{"voxel_cone_tracing_depth_of_field", "final"}}) {
    const ImageBuffer dense = rendered(pipeline(row.pipeline), row.output);
    const ImageBuffer octree = rendered(throughOctree(row.pipeline), row.output);
    const double flip = compare(octree, dense).flip;
    CAPTURE(row.pipeline, flip);
    CHECK(flip < 0.01);
  }
}
