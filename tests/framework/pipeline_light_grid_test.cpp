// Light in voxels without colour: one volume of coefficients in place of three.
#include <cmath>
#include <limits>

#include "lumivox/pipeline/ports.h"
#include "pipeline_toys.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

/// A grid of one volume of ones, in which one voxel is not a number where it is asked for.
struct Grey : Toy {
  using Toy::Toy;
  Param<bool> ill{this, "ill", false, "voxel (1, 2, 3) is not a number"};
  Out<ShGrid> light{this, "light"};
  Out<Image> radiance{this, "radiance", Contributes::direct};
  void run(PassContext& frame) override {
    note();
    radiance = paint(frame, 1.0f);
    gpu::TextureDescription description;
    description.kind = gpu::TextureKind::d3;
    description.format = gpu::Format::rgba32f;
    description.width = description.height = description.depth = 4;
    const gpu::TextureRef volume = frame.texture(description, "light");
    std::vector<float> values(4 * 64, 1.0f);
    if (ill) values[4 * (1 + 4 * (2 + 4 * 3))] = std::numeric_limits<float>::quiet_NaN();
    volume->upload(0, std::as_bytes(std::span(values)));
    ShGrid grid;
    grid.levels.push_back({{{0, 0, 0}, 1.0f, {4, 4, 4}}, {volume, nullptr, nullptr}});
    light = std::move(grid);
  }
};

}  // namespace

TEST_CASE("light of one volume alone is scanned, exported and pooled as that volume") {
  Fixture f;
  f.techniques.add<Grey>("toy", "grey");
  const RenderOptions options = with(&RenderOptions::health);
  PipelineExecutor well = f.executor("pass a toy.grey { }\noutput o a.radiance", options);
  well.keepOutput("a", "light");
  CHECK(well.render(0.0).healthFindings.empty());
  // Twice: its volume goes to the pool and comes back.
  well.invalidate();
  CHECK(well.render(0.0).healthFindings.empty());
  const PortContents contents = well.output("a", "light")->contents();
  CHECK(contents.resources().size() == 1);
  CHECK(contents.resources()[0].what->name == "red");
  REQUIRE(contents.fields().size() == 4);
  for (const PortContents::Field& field : contents.fields()) {
    const auto& texels = std::get<VoxelTexels>(field.source);
    REQUIRE(texels.textures.size() == 3);
    CHECK(texels.textures[1] == texels.textures[0]);
    CHECK(texels.textures[2] == texels.textures[0]);
  }
  PipelineExecutor ill = f.executor("pass a toy.grey { ill on }\noutput o a.radiance", options);
  ill.keepOutput("a", "light");
  CHECK(ill.render(0.0).healthFindings ==
        std::vector<std::string>{"pass a, port light: 1 NaN, first at voxel (1, 2, 3)"});
}
