// Near-field voxels over things that deform, a frame of a sequence against the same frame alone; with models
// where they are.
#include "lumivox/base/error.h"
#include "lumivox/base/log.h"
#include "support/near_field_scene.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::near_field;

namespace {

std::optional<Scene> whereItsModelsAre(const std::string& name) {
  const LogCapture quiet;
  try {
    return committed(name);
  } catch (const AbsentError& absent) {
    skip(absent.what());
    return std::nullopt;
  }
}

/// Both at four times, the last of which goes back; how many texels of the indirect light change from time to
/// time.
void checkSequence(const Scene& scene) {
  const Pipeline text = pipeline("near_field_voxels");
  RenderOptions options;
  options.width = 48;
  options.height = 36;
  options.parameters = text.settings({"resolution=48", "rays=8"});
  PipelineExecutor sequence(device(), techniques(), scene, text, options);
  sequence.keepOutput("bits", "bits");
  const auto bitsOf = [](const PipelineExecutor& executor) {
    const BinaryGrid& grid = static_cast<const Out<BinaryGrid>*>(executor.output("bits", "bits"))->value();
    return std::pair(grid.stacks.get(), cellsOf(grid));
  };
  const gpu::Texture* kept = nullptr;
  std::set<Cell> before;
  std::vector<float> lightBefore;
  int frame = 0;
  for (const double time : {0.0, 0.15, 0.55, 0.3}) {
    const FrameResult ofSequence = sequence.render(time, frame++);
    PipelineExecutor fresh(device(), techniques(), scene, text, options);
    fresh.keepOutput("bits", "bits");
    const FrameResult alone = fresh.render(time);
    CAPTURE(scene.name, time);
    for (const char* output : {"indirect_diffuse", "final"})
      CHECK(ofSequence.outputs.at(output).values() == alone.outputs.at(output).values());
    const auto [stacks, cells] = bitsOf(sequence);
    CHECK(cells == bitsOf(fresh).second);
    CHECK(cells != before);
    const std::vector<float>& light = ofSequence.outputs.at("indirect_diffuse").values();
    CHECK(light != lightBefore);
    // What stands still is kept: from the second frame on the same texture.
    if (frame > 2) CHECK(stacks == kept);
    kept = stacks;
    before = cells;
    lightBefore = light;
  }
}

}  // namespace

TEST_CASE("a frame of a cloth that deforms is the same alone and in a sequence") {
  checkSequence(committed("waving_cloth"));
}

TEST_CASE("a frame of a horse that gallops in an arena and in Sponza is the same alone and in a sequence") {
  for (const char* name : {"horse_arena", "horse_sponza"})
    if (const std::optional<Scene> scene = whereItsModelsAre(name)) checkSequence(*scene);
}
