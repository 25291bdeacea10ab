// A technique that brings a kind of port of its own gets connection, health, measures, export and
// documentation with it: tests/framework/plugins/own_kind.cpp.
#include <openvdb/openvdb.h>

#include "lumivox/base/error.h"
#include "lumivox/experiment/voxelizers.h"
#include "lumivox/plugin/loader.h"
#include "support/scene_builder.h"
#include "support/techniques.h"
#include "tools/cli_support.h"
#include "tools/vdbexport_support.h"
#include "vdbexport/export.h"

using namespace lumivox;
using namespace lumivox::test;
using Catch::Matchers::Contains;

namespace {

std::filesystem::path pluginDirectory() {
  return binaryDirectory() / "tests/plugins/own_kind";
}

Pipeline plantPipeline(const std::string& sign = "positive") {
  return Pipeline::parse("pipeline \"plant\" {\n  pass plant own_kind.plant { sign " + sign +
                             " }\n  pass look own_kind.look { leaves plant.leaves }\n  output direct "
                             "look.radiance\n}\n",
                         "plant.pipeline");
}

Scene smallScene() {
  SceneBuilder builder;
  builder.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, builder.lambert(0.6f));
  builder.look({0, 1, 4}, {0, 0, 0}, {0, 1, 0}, 0.7, 8, 8);
  return builder.scene;
}

}  // namespace

TEST_CASE("a technique's own kind of port connects its passes, and its health is scanned by its table") {
  TechniqueSet set({pluginDirectory()});
  const Scene scene = smallScene();
  RenderOptions options;
  options.health = true;
  for (const char* sign : {"positive", "negative"}) {
    PipelineExecutor executor(device(), set, scene, plantPipeline(sign), options);
    const FrameResult frame = executor.render(0.0, 0);
    CHECK(frame.outputs.at("direct").at(0, 0, 0) == 2.0f);
    if (std::string(sign) == "positive") CHECK(frame.healthFindings.empty());
    if (std::string(sign) == "negative") {
      REQUIRE(frame.healthFindings.size() == 1);
      CHECK_THAT(frame.healthFindings[0], Contains("port leaves: 1 negative, first at pixel (1, 0)"));
    }
  }
}

TEST_CASE("a technique's own kind of port is measured and exported like the framework's") {
  TechniqueSet set({pluginDirectory()});
  const Scene scene = smallScene();
  PipelineExecutor executor(device(), set, scene, plantPipeline(), {});
  executor.keepOutput("plant", "leaves");
  executor.render(0.0, 0);
  const auto voxels = occupiedVoxels(*executor.output("plant", "leaves"));
  REQUIRE(voxels);
  CHECK(voxels->voxels.count() == 9);
  CHECK(voxels->voxels.contains({1, 1, 1}));
  CHECK(voxels->voxels.contains({3, 3, 3}));
  CHECK_FALSE(voxels->voxels.contains({2, 2, 2}));
  CHECK(voxels->bytes == 2 * sizeof(float));

  openvdb::initialize();
  vdb::Exporter exporter(device(), set, scene, plantPipeline(), {}, {{"plant.leaves"}, {0}, false});
  const std::vector<vdb::NamedField> fields = exporter.render(0.0, 0);
  REQUIRE(fields.size() == 1);
  CHECK(fields[0].name == "plant.leaves.radiance");
  CHECK(fields[0].field.unit == "W/(sr m^2)");
  const auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(exporter.grid(fields[0], {}));
  REQUIRE(grid);
  CHECK(grid->activeVoxelCount() == 9);
  CHECK(grid->getConstAccessor().getValue({1, 0, 1}) == 2.0f);
  CHECK(grid->getConstAccessor().getValue({3, 3, 3}) == 3.0f);
  CHECK(grid->getConstAccessor().getValue({2, 2, 2}) == 0.0f);
}

TEST_CASE("a technique's own kind of port is documented beside the framework's") {
  const std::string techniques = " --techniques '" + pluginDirectory().string() + "'";
  const std::string word = runCommand("lumivox describe Leaves" + techniques).output;
  CHECK_THAT(word, Contains("port kind Leaves") && Contains("exported as radiance (W/(sr m^2))") &&
                       Contains("occupied: voxels in leaves that shine"));
  const std::string page = runCommand("lumivox describe --markdown" + techniques).output;
  CHECK_THAT(page, Contains("| `Leaves`: radiance in leaves of different sizes |") &&
                       Contains("| `GBuffer`: what the camera sees, per pixel |"));
}
