// Whose bytes textures and buffers are, and read-only ones that exist once for all who want the same bits.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>

#include "lumivox/base/hash.h"
#include "lumivox/gpu/device.h"

namespace lumivox::gpu {

/// Bytes of one owner's textures and buffers, as if it were alone on the device: what it shares with others
/// counts in full, and what only others hold does not.
class MemoryAccount {
 public:
  std::uint64_t bytes() const { return bytes_; }
  std::uint64_t sharedBytes() const { return sharedBytes_; }  ///< of bytes(): from sharedResource()
  std::uint64_t peakBytes() const { return peakBytes_; }      ///< since resetPeak()
  void resetPeak() { peakBytes_ = bytes_; }

  void add(std::uint64_t bytes);
  void remove(std::uint64_t bytes);
  /// The same for something that others may hold too; asked for twice, it counts once.
  void hold(const void* shared, std::uint64_t bytes);
  void release(const void* shared, std::uint64_t bytes);

 private:
  std::uint64_t bytes_ = 0, sharedBytes_ = 0, peakBytes_ = 0;
  std::map<const void*, int> holds_;
};

/// While it lives, what is allocated on a device is charged to an account (null: to none), and taken off it
/// when it is freed, whenever that is.
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

/// Bytes on the account that is charged when it is made, as long as it lives.
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

/// The resource of a device with these contents: made when nobody holds one, else the one that is there. It
/// is freed with its last holder. What `make` throws leaves nothing behind. `contents` stands for every bit
/// and the shape; whoever holds it never writes to it.
template <class Resource>
std::shared_ptr<const Resource> sharedResource(Device& device, const ContentHash& contents,
                                               const std::function<std::unique_ptr<Resource>()>& make);

}  // namespace lumivox::gpu
