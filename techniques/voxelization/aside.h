// Work that one thread leaves to many.
#pragma once

#include <cstdint>

#include "lumivox/pipeline/pass.h"

namespace lumivox::voxelization {

/// Items that a dispatch puts aside because they would keep one thread too long, and that the next one shares
/// out over many threads. Shader side: shaders/voxelization/aside.glsl.
class Aside {
 public:
  /// Room for so many items.
  Aside(PassContext& frame, std::uint64_t mostItems);

  const gpu::BufferRef& buffer() const { return buffer_; }
  /// Before the dispatch that puts items aside.
  void clear();
  /// Behind that dispatch and its barrier; a barrier follows.
  void workOff(PassContext& frame, const shader::BoundProgram& program,
               const shader::BindingSet& bindings) const;

 private:
  gpu::BufferRef buffer_;
};

}  // namespace lumivox::voxelization
