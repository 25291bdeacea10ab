// A program whose blocks count how often they run.
#pragma once

#include <vector>

#include "lumivox/shader/library.h"
#include "shader/instrument.h"

namespace lumivox::shader {

class CountingProgram {
 public:
  CountingProgram(gpu::Device& device, const PackedProgram& packed,
                  const std::vector<gpu::StageCode>& stages);
  /// The instrumented stages, to be linked in place of the original ones.
  std::vector<gpu::StageCode> stages() const;
  gpu::ResourceBinding counters() const;
  /// Work done since the last call, with these resources bound.
  Work take(const std::vector<gpu::ResourceBinding>& bound);

 private:
  struct Stage {
    gpu::Stage stage;
    CountingCode code;
  };
  std::uint32_t binding_ = 0;
  std::vector<Stage> stages_;
  std::unique_ptr<gpu::Buffer> counters_;
};

}  // namespace lumivox::shader
