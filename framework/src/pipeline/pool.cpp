#include "pipeline/pool.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "gpu/memory.h"
#include "lumivox/base/error.h"

namespace lumivox {

namespace {

template <class Resource>
struct ShapeOf;
template <>
struct ShapeOf<gpu::Texture> {
  using Type = gpu::TextureDescription;
};
template <>
struct ShapeOf<gpu::Buffer> {
  using Type = std::uint64_t;  ///< bytes
};

gpu::TextureDescription shapeOf(const gpu::Texture& texture) {
  return texture.description();
}
std::uint64_t shapeOf(const gpu::Buffer& buffer) {
  return buffer.sizeBytes();
}
std::uint64_t bytesOf(const gpu::TextureDescription& shape) {
  return shape.sizeBytes();
}
std::uint64_t bytesOf(std::uint64_t shape) {
  return shape;
}

/// A pool's right to a waiting resource of a shape.
template <class Resource>
struct Slot {
  typename ShapeOf<Resource>::Type shape;
  std::string label;
  const Resource* last;    ///< its last resource, taken again if it is free
  std::uint64_t lastUsed;  ///< frame of the last request that it served
  gpu::Charge charge;
};

/// A pair of containers, for textures and for buffers.
template <template <class> class List>
struct OfBoth {
  List<gpu::Texture> textures;
  List<gpu::Buffer> buffers;

  template <class Resource>
  List<Resource>& of() {
    if constexpr (std::is_same_v<Resource, gpu::Texture>) {
      return textures;
    } else {
      return buffers;
    }
  }
};

template <class Resource>
using Slots = std::vector<Slot<Resource>>;
template <class Resource>
using Waiting = std::vector<std::unique_ptr<Resource>>;

}  // namespace

// ---- memory
// --------------------------------------------------------------------------------------------------

struct TransientMemory::State {
  gpu::Device& device;
  std::vector<OfBoth<Slots>*> pools;
  OfBoth<Waiting> waiting;

  /// Takes a free resource of this shape, preferably `wanted`; null if none is free.
  template <class Resource, class Shape>
  std::unique_ptr<Resource> take(const Shape& shape, const Resource* wanted) {
    auto& all = waiting.of<Resource>();
    auto best = all.end();
    for (auto one = all.begin(); one != all.end(); ++one)
      if (one->get() == wanted || (shapeOf(**one) == shape && (best == all.end() || best->get() != wanted)))
        best = one;
    if (best == all.end()) return nullptr;
    std::unique_ptr<Resource> resource = std::move(*best);
    all.erase(best);
    return resource;
  }

  template <class Resource>
  std::unique_ptr<Resource> make(const typename ShapeOf<Resource>::Type& shape, const std::string& label) {
    const gpu::Charging nobody(device, nullptr);  // slots are charged
    return std::make_unique<Resource>(device, shape, label);
  }

  /// The number of this shape to keep free: that of the pool with the most slots of it.
  template <class Resource, class Shape>
  std::size_t needed(const Shape& shape) const {
    std::size_t most = 0;
    for (OfBoth<Slots>* pool : pools) {
      const auto& slots = pool->of<Resource>();
      most = std::max(most, static_cast<std::size_t>(std::count_if(
                                slots.begin(), slots.end(),
                                [&](const Slot<Resource>& slot) { return slot.shape == shape; })));
    }
    return most;
  }

  /// Frees unneeded resources, first those that no slot held last.
  template <class Resource>
  void trim() {
    auto& all = waiting.of<Resource>();
    std::stable_partition(all.begin(), all.end(), [&](const std::unique_ptr<Resource>& one) {
      return std::any_of(pools.begin(), pools.end(), [&](OfBoth<Slots>* pool) {
        const auto& slots = pool->of<Resource>();
        return std::any_of(slots.begin(), slots.end(),
                           [&](const Slot<Resource>& slot) { return slot.last == one.get(); });
      });
    });
    Waiting<Resource> kept;
    for (std::unique_ptr<Resource>& one : all) {
      const auto shape = shapeOf(*one);
      if (count(kept, shape) < needed<Resource>(shape)) kept.push_back(std::move(one));
    }
    all = std::move(kept);
  }

  /// Creates replacements for resources that a pool holds and others need.
  template <class Resource>
  void refill() {
    auto& all = waiting.of<Resource>();
    for (OfBoth<Slots>* pool : pools)
      for (const Slot<Resource>& slot : pool->of<Resource>())
        while (count(all, slot.shape) < needed<Resource>(slot.shape))
          all.push_back(make<Resource>(slot.shape, slot.label));
  }

  void trimBoth() {
    trim<gpu::Texture>();
    trim<gpu::Buffer>();
  }

 private:
  template <class Resource, class Shape>
  static std::size_t count(const Waiting<Resource>& all, const Shape& shape) {
    return static_cast<std::size_t>(std::count_if(
        all.begin(), all.end(),
        [&](const std::unique_ptr<Resource>& one) { return one != nullptr && shapeOf(*one) == shape; }));
  }
};

TransientMemory::TransientMemory(gpu::Device& device) : state_(new State{device, {}, {}}) {}
TransientMemory::~TransientMemory() = default;

std::uint64_t TransientMemory::waitingBytes() const {
  std::uint64_t sum = 0;
  for (const auto& texture : state_->waiting.textures) sum += texture->sizeBytes();
  for (const auto& buffer : state_->waiting.buffers) sum += buffer->sizeBytes();
  return sum;
}

// ---- pool
// ----------------------------------------------------------------------------------------------------

struct ResourcePool::State {
  gpu::Device& device;
  bool sharing;
  std::shared_ptr<TransientMemory::State> memory;
  std::uint64_t frame = 0, bytes = 0, sharedBytes = 0;
  OfBoth<Slots> slots;

  State(gpu::Device& gpuDevice, bool shares, std::shared_ptr<TransientMemory::State> transientMemory)
      : device(gpuDevice), sharing(shares), memory(std::move(transientMemory)) {
    memory->pools.push_back(&slots);
  }
  ~State() {
    std::erase(memory->pools, &slots);
    memory->trimBoth();
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  /// Returns a resource on its last reference. The pool may be destroyed before; others can then use the
  /// resource.
  template <class Resource>
  struct Return {
    std::weak_ptr<State> pool;
    std::shared_ptr<TransientMemory::State> memory;
    std::uint64_t frame;
    std::string label;
    std::shared_ptr<gpu::Charge> charge;

    void operator()(Resource* returned) {
      std::unique_ptr<Resource> owned(returned);
      const std::shared_ptr<State> alive = pool.lock();
      if (alive != nullptr)
        alive->slots.template of<Resource>().push_back(
            {shapeOf(*owned), std::move(label), returned, frame, std::move(*charge)});
      memory->waiting.of<Resource>().push_back(std::move(owned));
      if (alive == nullptr) memory->trim<Resource>();
    }
  };

  /// A free resource of this shape, or a new one; it becomes free again on its last reference.
  template <class Resource, class Shape>
  static std::shared_ptr<Resource> take(const std::shared_ptr<State>& state, const Shape& shape,
                                        const std::string& label) {
    auto& slots = state->slots.of<Resource>();
    // Prefers a resource that this frame has used already, so that the others can be freed at its end.
    auto best = slots.end();
    for (auto one = slots.begin(); one != slots.end(); ++one) {
      if (one->shape != shape || (!state->sharing && one->lastUsed == state->frame)) continue;
      if (best == slots.end() || one->lastUsed > best->lastUsed) best = one;
    }
    const bool waits = best != slots.end();
    std::unique_ptr<Resource> resource =
        state->memory->take<Resource>(shape, waits ? best->last : static_cast<const Resource*>(nullptr));
    if (resource == nullptr) resource = state->memory->make<Resource>(shape, label);
    std::shared_ptr<gpu::Charge> charge;
    if (waits) {
      if (best->lastUsed == state->frame) state->sharedBytes += bytesOf(shape);
      charge = std::make_shared<gpu::Charge>(std::move(best->charge));
      slots.erase(best);
    } else {
      charge = std::make_shared<gpu::Charge>(state->device, bytesOf(shape));
      state->bytes += bytesOf(shape);
    }
    return std::shared_ptr<Resource>(
        resource.release(), Return<Resource>{state, state->memory, state->frame, label, std::move(charge)});
  }

  template <class Resource>
  void freeUnused() {
    auto& all = slots.of<Resource>();
    for (const Slot<Resource>& slot : all)
      if (slot.lastUsed != frame) bytes -= bytesOf(slot.shape);
    std::erase_if(all, [this](const Slot<Resource>& slot) { return slot.lastUsed != frame; });
  }
};

ResourcePool::ResourcePool(gpu::Device& device, bool sharing, const std::shared_ptr<TransientMemory>& memory)
    : state_(std::make_shared<State>(device, sharing,
                                     memory && sharing ? memory->state_ : TransientMemory(device).state_)) {
  if (memory && &memory->state_->device != &device)
    throw Error("memory shared between executors is of another device; expected one of theirs");
}
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

void ResourcePool::endFrame(bool freesUnused) {
  State& s = *state_;
  if (freesUnused) {
    s.freeUnused<gpu::Texture>();
    s.freeUnused<gpu::Buffer>();
  }
  s.memory->trimBoth();
  s.memory->refill<gpu::Texture>();
  s.memory->refill<gpu::Buffer>();
}

std::uint64_t ResourcePool::bytes() const {
  return state_->bytes;
}
std::uint64_t ResourcePool::sharedBytes() const {
  return state_->sharedBytes;
}

}  // namespace lumivox
