#include "gpu/memory.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "gpu/state.h"

namespace lumivox::gpu {

// ---- accounts
// -----------------------------------------------------------------------------------------------------

void MemoryAccount::add(std::uint64_t bytes) {
  bytes_ += bytes;
  peakBytes_ = std::max(peakBytes_, bytes_);
}

void MemoryAccount::remove(std::uint64_t bytes) {
  assert(bytes_ >= bytes);
  bytes_ -= bytes;
}

void MemoryAccount::hold(const void* shared, std::uint64_t bytes) {
  if (holds_[shared]++ > 0) return;
  add(bytes);
  sharedBytes_ += bytes;
}

void MemoryAccount::release(const void* shared, std::uint64_t bytes) {
  const auto found = holds_.find(shared);
  assert(found != holds_.end());
  if (--found->second > 0) return;
  holds_.erase(found);
  remove(bytes);
  sharedBytes_ -= bytes;
}

Charging::Charging(Device& device, std::shared_ptr<MemoryAccount> account)
    : device_(device.state()), before_(std::exchange(device_->account, std::move(account))) {}

Charging::~Charging() {
  device_->account = std::move(before_);
}

Charge::Charge(Device& device, std::uint64_t bytes) : account_(device.state()->account), bytes_(bytes) {
  if (account_) account_->add(bytes_);
}

Charge::~Charge() {
  if (account_) account_->remove(bytes_);
}

Charge& Charge::operator=(Charge&& other) noexcept {
  std::swap(account_, other.account_);
  std::swap(bytes_, other.bytes_);
  return *this;
}

// ---- shared resources
// ---------------------------------------------------------------------------------------------

namespace {

/// One holder's part of a shared resource.
template <class Resource>
struct Hold {
  Hold(std::shared_ptr<const Resource> shared, std::shared_ptr<MemoryAccount> charged)
      : resource(std::move(shared)), account(std::move(charged)) {
    account->hold(resource.get(), resource->sizeBytes());
  }
  ~Hold() { account->release(resource.get(), resource->sizeBytes()); }
  Hold(const Hold&) = delete;
  Hold& operator=(const Hold&) = delete;

  std::shared_ptr<const Resource> resource;
  std::shared_ptr<MemoryAccount> account;
};

SharedResources<Texture>& sharedOf(DeviceState& device, const Texture*) {
  return device.sharedTextures;
}
SharedResources<Buffer>& sharedOf(DeviceState& device, const Buffer*) {
  return device.sharedBuffers;
}

}  // namespace

template <class Resource>
std::shared_ptr<const Resource> sharedResource(Device& device, const ContentHash& contents,
                                               const std::function<std::unique_ptr<Resource>()>& make) {
  DeviceState& state = *device.state();
  SharedResources<Resource>& all = sharedOf(state, static_cast<const Resource*>(nullptr));
  const auto found = all.find(contents);
  std::shared_ptr<const Resource> resource = found == all.end() ? nullptr : found->second.lock();
  if (resource == nullptr) {
    const Charging nobody(device, nullptr);
    resource = make();
    std::erase_if(all, [](const auto& one) { return one.second.expired(); });
    all[contents] = resource;
  }
  if (state.account == nullptr) return resource;
  const auto hold = std::make_shared<Hold<Resource>>(std::move(resource), state.account);
  return {hold, hold->resource.get()};
}

template std::shared_ptr<const Texture> sharedResource(Device&, const ContentHash&,
                                                       const std::function<std::unique_ptr<Texture>()>&);
template std::shared_ptr<const Buffer> sharedResource(Device&, const ContentHash&,
                                                      const std::function<std::unique_ptr<Buffer>()>&);

}  // namespace lumivox::gpu
