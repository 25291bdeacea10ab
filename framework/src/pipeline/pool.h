// Textures and buffers for passes. Resources of the same shape are reused within a frame, so that short-lived
// ones share memory.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "lumivox/gpu/device.h"

namespace lumivox {

/// Holds the free resources of pools. Executors of which only one renders at a time may share it, so that
/// their free resources exist once. A resource that a request holds (a kept result, a history) is never
/// shared.
class TransientMemory {
 public:
  explicit TransientMemory(gpu::Device& device);
  ~TransientMemory();
  std::uint64_t waitingBytes() const;

 private:
  friend class ResourcePool;
  struct State;
  std::shared_ptr<State> state_;
};

class ResourcePool {
 public:
  /// Without sharing, a resource serves one request per frame, and no other pool. `memory`: null for one of
  /// its own. Error if it belongs to another device.
  ResourcePool(gpu::Device& device, bool sharing, const std::shared_ptr<TransientMemory>& memory = nullptr);
  ~ResourcePool();

  gpu::TextureRef texture(const gpu::TextureDescription& description, const std::string& label);
  gpu::BufferRef buffer(std::uint64_t sizeBytes, const std::string& label);

  void beginFrame();
  /// If `freesUnused`, frees what nobody holds and no request of this frame used. Keeps enough free resources
  /// for the next executor that renders.
  void endFrame(bool freesUnused = true);

  /// Bytes of all its resources, in use or free, as if it shared no memory.
  std::uint64_t bytes() const;
  std::uint64_t sharedBytes()
      const;  ///< bytes of requests that this frame served with memory that it had used before

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace lumivox
