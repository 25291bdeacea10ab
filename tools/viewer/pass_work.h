// The work and the memory of passes, counted in a frame of its own.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "lumivox/pipeline/pipeline.h"
#include "lumivox/results/records.h"

namespace lumivox::viewer {

struct PassWork {
  std::vector<WorkBound> bounds;               ///< lowerBounds() of the pass's time; empty: unknown
  std::map<std::string, std::uint64_t> bytes;  ///< of its outputs, by their names
};
struct FrameWork {
  std::map<std::string, PassWork> passes;
  std::string why;  ///< bounds are unknown; empty: they are known
};

/// Renders with an executor that counts operations, several times slower than others, and keeps every wanted
/// output. `why` says why there are no bounds: the device takes GLSL, or its peak rates were not measured.
FrameWork countFrame(gpu::Device& device, TechniqueSource& techniques, const Scene& scene,
                     const Pipeline& pipeline, const SceneSnapshot& snapshot, RenderOptions options);

}  // namespace lumivox::viewer
