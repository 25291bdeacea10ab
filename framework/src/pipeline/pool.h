// Textures and buffers for passes. What one pass no longer needs, another of the same shape gets: short-lived
// resources share memory.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "lumivox/gpu/device.h"

namespace lumivox {

class ResourcePool {
 public:
  /// Without sharing, a resource serves one request per frame.
  ResourcePool(gpu::Device& device, bool sharing);
  ~ResourcePool();

  gpu::TextureRef texture(const gpu::TextureDescription& description, const std::string& label);
  gpu::BufferRef buffer(std::uint64_t sizeBytes, const std::string& label);

  void beginFrame();
  /// Frees what no request of this frame used and nobody holds.
  void endFrame();

  std::uint64_t bytes() const;  ///< of all its resources, in use or waiting
  std::uint64_t sharedBytes()
      const;  ///< requests of this frame that were served with memory which it had used before

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace lumivox
