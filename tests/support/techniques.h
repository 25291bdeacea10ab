// The device and the built technique libraries, made once per test program.
#pragma once

#include "lumivox/gpu/device.h"
#include "lumivox/pipeline/pipeline.h"
#include "lumivox/plugin/loader.h"
#include "support/support.h"

namespace lumivox::test {

inline gpu::Device& device() {
  static gpu::Device instance;
  return instance;
}

/// The built techniques, unless LUMIVOX_TECHNIQUES names others, as tests/mutation/mutate does.
inline TechniqueSet& techniques() {
  static TechniqueSet instance(TechniqueSet::defaultDirectories({}));
  return instance;
}

/// A committed pipeline.
inline Pipeline pipeline(const std::string& name) {
  return Pipeline::load(sourceDirectory() / "scenes/pipelines" / (name + ".pipeline"));
}

/// One frame of a scene through a pipeline.
inline FrameResult renderOnce(const Scene& scene, const Pipeline& pipeline, RenderOptions options = {}) {
  return PipelineExecutor(device(), techniques(), scene, pipeline, options).render(0.0);
}

}  // namespace lumivox::test
