// Textures and buffers for passes. What one pass no longer needs, another of the same shape gets: short-lived
// resources share memory.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "lumivox/gpu/device.h"

namespace lumivox {

/// Where resources wait that no request holds. The pools of executors of which only one renders at a time may
/// have one between them: what all of them hold waiting is then there once. What a request holds (results
/// that are kept, histories) is never another's.
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
  /// Without sharing, a resource serves one request per frame, and no other pool. Error when `memory` (null:
  /// one of its own) is of another device.
  ResourcePool(gpu::Device& device, bool sharing, const std::shared_ptr<TransientMemory>& memory = nullptr);
  ~ResourcePool();

  gpu::TextureRef texture(const gpu::TextureDescription& description, const std::string& label);
  gpu::BufferRef buffer(std::uint64_t sizeBytes, const std::string& label);

  void beginFrame();
  /// Frees what no request of this frame used and nobody holds (where `freesUnused`), and sees to it that
  /// whoever renders next finds what it left waiting.
  void endFrame(bool freesUnused = true);

  /// Of all its resources, in use or waiting: as many as if it had its memory alone.
  std::uint64_t bytes() const;
  std::uint64_t sharedBytes()
      const;  ///< requests of this frame that were served with memory which it had used before

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace lumivox
