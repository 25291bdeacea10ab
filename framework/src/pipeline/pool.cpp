#include "pipeline/pool.h"

#include <algorithm>
#include <vector>

namespace lumivox {

namespace {

template <class Resource>
struct Waiting {
  std::unique_ptr<Resource> resource;
  std::uint64_t lastUsed;  ///< frame of the last request that it served
};

bool fits(const gpu::Texture& texture, const gpu::TextureDescription& wanted) {
  return texture.description() == wanted;
}
bool fits(const gpu::Buffer& buffer, std::uint64_t wanted) {
  return buffer.sizeBytes() == wanted;
}

}  // namespace

struct ResourcePool::State {
  gpu::Device& device;
  bool sharing;
  std::uint64_t frame = 0, bytes = 0, sharedBytes = 0;
  std::vector<Waiting<gpu::Texture>> textures;
  std::vector<Waiting<gpu::Buffer>> buffers;

  template <class Resource>
  std::vector<Waiting<Resource>>& waiting() {
    if constexpr (std::is_same_v<Resource, gpu::Texture>) {
      return textures;
    } else {
      return buffers;
    }
  }

  /// A waiting resource of this shape, or a new one; on its last reference it waits again.
  template <class Resource, class Shape>
  static std::shared_ptr<Resource> take(const std::shared_ptr<State>& state, const Shape& shape,
                                        const std::string& label) {
    auto& waiting = state->waiting<Resource>();
    // Of several that fit, one that this frame has used already: the others may then be freed at its end.
    auto best = waiting.end();
    for (auto one = waiting.begin(); one != waiting.end(); ++one) {
      if (!fits(*one->resource, shape) || (!state->sharing && one->lastUsed == state->frame)) continue;
      if (best == waiting.end() || one->lastUsed > best->lastUsed) best = one;
    }
    std::unique_ptr<Resource> resource;
    if (best != waiting.end()) {
      if (best->lastUsed == state->frame) state->sharedBytes += best->resource->sizeBytes();
      resource = std::move(best->resource);
      waiting.erase(best);
    } else {
      resource = std::make_unique<Resource>(state->device, shape, label);
      state->bytes += resource->sizeBytes();
    }
    // The pool may be gone before the last reference; the resource then dies with that.
    const std::uint64_t frame = state->frame;
    return std::shared_ptr<Resource>(resource.release(),
                                     [weak = std::weak_ptr<State>(state), frame](Resource* returned) {
                                       std::unique_ptr<Resource> owned(returned);
                                       if (const std::shared_ptr<State> pool = weak.lock()) {
                                         pool->waiting<Resource>().push_back({std::move(owned), frame});
                                       }
                                     });
  }

  template <class Resource>
  void freeUnused() {
    auto& all = waiting<Resource>();
    const auto unused = std::stable_partition(all.begin(), all.end(),
                                              [this](const auto& one) { return one.lastUsed == frame; });
    for (auto one = unused; one != all.end(); ++one) bytes -= one->resource->sizeBytes();
    all.erase(unused, all.end());
  }
};

ResourcePool::ResourcePool(gpu::Device& device, bool sharing)
    : state_(new State{device, sharing, 0, 0, 0, {}, {}}) {}
ResourcePool::~ResourcePool() = default;

gpu::TextureRef ResourcePool::texture(const gpu::TextureDescription& description, const std::string& label) {
  return State::take<gpu::Texture>(state_, description, label);
}
gpu::BufferRef ResourcePool::buffer(std::uint64_t sizeBytes, const std::string& label) {
  return State::take<gpu::Buffer>(state_, sizeBytes, label);
}

void ResourcePool::beginFrame() {
  ++state_->frame;
  state_->sharedBytes = 0;
}

void ResourcePool::endFrame() {
  state_->freeUnused<gpu::Texture>();
  state_->freeUnused<gpu::Buffer>();
}

std::uint64_t ResourcePool::bytes() const {
  return state_->bytes;
}
std::uint64_t ResourcePool::sharedBytes() const {
  return state_->sharedBytes;
}

}  // namespace lumivox
