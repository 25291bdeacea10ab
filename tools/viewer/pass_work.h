// What passes do and hold, beside how long they take: counted in a frame of its own.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "lumivox/pipeline/pipeline.h"
#include "lumivox/results/records.h"

namespace lumivox::viewer {

struct PassWork {
  std::vector<WorkBound> bounds;               ///< lowerBounds(): no pass can be faster; empty: not known
  std::map<std::string, std::uint64_t> bytes;  ///< of what its outputs hold, by their names
};
struct FrameWork {
  std::map<std::string, PassWork> passes;
  std::string why;  ///< no bounds are known; empty: they are
};

/// One frame of an executor that counts, several times slower than others, and keeps every output that is
/// wanted. Devices that take GLSL count nothing, and without measured peak rates there are no bounds: `why`.
FrameWork countFrame(gpu::Device& device, TechniqueSource& techniques, const Scene& scene,
                     const Pipeline& pipeline, const SceneSnapshot& snapshot, RenderOptions options);

}  // namespace lumivox::viewer
