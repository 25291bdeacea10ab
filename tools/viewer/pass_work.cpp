#include "viewer/pass_work.h"

#include "lumivox/base/error.h"
#include "lumivox/experiment/voxelizers.h"
#include "lumivox/pipeline/pass.h"
#include "lumivox/roofline/peak_rates.h"

namespace lumivox::viewer {

FrameWork countFrame(gpu::Device& device, TechniqueSource& techniques, const Scene& scene,
                     const Pipeline& pipeline, const SceneSnapshot& snapshot, RenderOptions options) {
  FrameWork work;
  const std::vector<PeakRate> peakRates = storedPeakRates(device, {});
  if (device.shaderInput() != gpu::ShaderInput::spirv) {
    work.why = "this device takes GLSL, and operations are counted in SPIR-V";
  } else if (peakRates.empty()) {
    work.why = "the peak rates of this device were not measured; `lumivox device` does";
  }
  options.countWork = work.why.empty();
  PipelineExecutor executor(device, techniques, scene, pipeline, options);
  const FrameResult frame = executor.render(snapshot, 0, PipelineExecutor::Images::no);
  for (const PassRecord& pass : frame.passes) {
    work.passes[pass.name].bounds = lowerBounds(pass.work, peakRates);
    for (const OutBase* output : executor.pass(pass.name).outputs())
      if (output->wanted()) work.passes[pass.name].bytes[output->name()] = 0;
  }
  // A second frame keeps all these outputs to its end, to read their sizes. Keeping an output wants no
  // further output and changes no size.
  for (const auto& [pass, held] : work.passes)
    for (const auto& [output, none] : held.bytes) executor.keepOutput(pass, output);
  executor.render(snapshot, 0, PipelineExecutor::Images::no);
  for (auto& [pass, held] : work.passes)
    for (auto& [name, bytes] : held.bytes)
      if (const OutBase* output = executor.output(pass, name)) bytes = heldBytes(*output);
  return work;
}

}  // namespace lumivox::viewer
