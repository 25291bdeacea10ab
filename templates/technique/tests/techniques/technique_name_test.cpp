// The technique against closed forms: scenes so small that their light is known.
#include <catch2/catch.hpp>

#include "lumivox/gpu/device.h"
#include "lumivox/pipeline/pipeline.h"
#include "lumivox/plugin/loader.h"
#include "lumivox/scene/builder.h"

using namespace lumivox;

namespace {

/// The output `indirect_diffuse` of the technique's pipeline.
ImageBuffer indirectDiffuse(const Scene& scene, const std::vector<std::string>& settings) {
  static gpu::Device device;
  static TechniqueSet techniques(TechniqueSet::defaultDirectories());
  const Pipeline pipeline = Pipeline::load("scenes/pipelines/technique_name.pipeline");
  RenderOptions options;
  options.parameters = pipeline.settings(settings);
  options.checkReads = true;  // as `lumivox render --check-reads`
  PipelineExecutor executor(device, techniques, scene, pipeline, options);
  const FrameResult frame = executor.render(0.0);
  // Names passes that read more than they declare: such a pass would not run again where it must.
  CHECK(frame.readsFindings == std::vector<std::string>());
  CHECK(executor.render(1.0).readsFindings == std::vector<std::string>());
  return frame.outputs.at("indirect_diffuse");
}

}  // namespace

TEST_CASE("a Lambert surface in light of radiance L from all sides reflects albedo times L") {
  SceneBuilder builder;
  builder.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, builder.lambert(0.25f));
  builder.look({0, 3, 0}, {0, 0, 0}, {0, 0, -1}, 0.3, 8, 8);
  const ImageBuffer image = indirectDiffuse(builder.scene, {"radiance=2"});
  // L arrives over the half space: E = pi L; a Lambert surface reflects albedo / pi of it.
  for (const float value : image.values()) CHECK(value == 0.25f * 2.0f);
}

TEST_CASE("where nothing is seen, nothing is reflected") {
  SceneBuilder builder;
  builder.look({0, 3, 0}, {0, 6, 0}, {0, 0, -1}, 0.3, 8, 8);
  const ImageBuffer image = indirectDiffuse(builder.scene, {});
  for (const float value : image.values()) CHECK(value == 0.0f);
}
