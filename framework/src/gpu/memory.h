// Accounts of the bytes of textures and buffers, and read-only resources that exist once for all holders of
// the same contents.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>

#include "lumivox/base/hash.h"
#include "lumivox/gpu/device.h"

namespace lumivox::gpu {

/// Bytes of one owner's textures and buffers, as if it were alone on the device: shared resources count in
/// full, and resources of others do not count.
class MemoryAccount {
 public:
  std::uint64_t bytes() const { return bytes_; }
  std::uint64_t sharedBytes() const { return sharedBytes_; }  ///< the part of bytes() from sharedResource()
  std::uint64_t peakBytes() const { return peakBytes_; }      ///< since resetPeak()
  void resetPeak() { peakBytes_ = bytes_; }

  void add(std::uint64_t bytes);
  void remove(std::uint64_t bytes);
  /// The same for a resource that others may hold too; held twice by one owner, it counts once.
  void hold(const void* shared, std::uint64_t bytes);
  void release(const void* shared, std::uint64_t bytes);

 private:
  std::uint64_t bytes_ = 0, sharedBytes_ = 0, peakBytes_ = 0;
  std::map<const void*, int> holds_;
};

/// While it lives, allocations on a device are charged to an account (null: to none). They leave the account
/// when they are freed, also later.
class Charging {
 public:
  Charging(Device& device, std::shared_ptr<MemoryAccount> account);
  ~Charging();
  Charging(const Charging&) = delete;
  Charging& operator=(const Charging&) = delete;

 private:
  std::shared_ptr<DeviceState> device_;
  std::shared_ptr<MemoryAccount> before_;
};

/// Charges bytes to the current account for as long as it lives.
class Charge {
 public:
  Charge(Device& device, std::uint64_t bytes);
  ~Charge();
  Charge(Charge&& other) noexcept = default;
  Charge& operator=(Charge&& other) noexcept;

 private:
  std::shared_ptr<MemoryAccount> account_;
  std::uint64_t bytes_ = 0;
};

/// The resource of a device with these contents: the existing one, or the result of `make` if nobody holds
/// one. It is freed with its last holder. If `make` throws, nothing is left behind. `contents` identifies
/// every bit and the shape. Holders never write to it.
template <class Resource>
std::shared_ptr<const Resource> sharedResource(Device& device, const ContentHash& contents,
                                               const std::function<std::unique_ptr<Resource>()>& make);

}  // namespace lumivox::gpu
