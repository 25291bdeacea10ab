// The voxels that a camera sees of a floor from above.
#include <catch2/catch.hpp>

#include "lumivox/gpu/device.h"
#include "lumivox/pipeline/pipeline.h"
#include "lumivox/plugin/loader.h"
#include "lumivox/scene/builder.h"

using namespace lumivox;

TEST_CASE("every surface that is seen lies in a voxel that is marked, and nothing else does") {
  SceneBuilder builder;
  builder.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, builder.lambert(0.5f));
  builder.look({0, 3, 0}, {0, 0, 0}, {0, 0, -1}, 1.0, 16, 16);  // some rays miss the floor
  gpu::Device device;
  TechniqueSet techniques(TechniqueSet::defaultDirectories());
  const Pipeline pipeline = Pipeline::load("scenes/pipelines/seen_voxels.pipeline");
  PipelineExecutor executor(device, techniques, builder.scene, pipeline, {});
  const ImageBuffer shown = executor.render(0.0).outputs.at("shown");
  // The floor fills the image within atan(1 / 3) of the view axis, which is 0.61 of the image's half height.
  CHECK(shown.at(8, 8, 0) == 1.0f);
  CHECK(shown.at(4, 8, 0) == 1.0f);
  CHECK(shown.at(1, 8, 0) == 0.0f);
}
