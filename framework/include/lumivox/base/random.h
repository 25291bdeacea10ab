// Counter-based random numbers: the n-th number of a stream depends on (key, counter) only, never on the
// order of evaluation or the number of threads. Philox4x32-10 (Salmon, Moraes, Dror, Shaw 2011, "Parallel
// random numbers: as easy as 1, 2, 3", Sec. 3.3).
#pragma once

#include <array>
#include <cstdint>

namespace lumivox {

/// One Philox4x32-10 block: 128 random bits from a 128-bit counter and a 64-bit key.
std::array<std::uint32_t, 4> philox4x32(std::array<std::uint32_t, 4> counter,
                                        std::array<std::uint32_t, 2> key);

/// The blocks of this counter and of the next (first word one higher), computed side by side in little more
/// time than one of them.
std::array<std::uint32_t, 8> philox4x32Pair(std::array<std::uint32_t, 4> counter,
                                            std::array<std::uint32_t, 2> key);

/// A stream of uniform numbers in [0, 1), addressed by (seed, stream a, stream b); numbers are consumed in
/// order.
class RandomStream {
 public:
  RandomStream(std::uint64_t seed, std::uint32_t streamA, std::uint32_t streamB = 0)
      : key_{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)},
        a_(streamA),
        b_(streamB) {}

  std::uint32_t bits() {
    if (used_ == 8) refill();
    return block_[used_++];
  }
  /// Uniform in [0, 1): 24 random bits, so that the result is exactly representable and never 1.
  float uniform() { return static_cast<float>(bits() >> 8) * 0x1.0p-24f; }

 private:
  void refill() {
    block_ = philox4x32Pair({index_, 0u, a_, b_}, key_);
    index_ += 2;
    used_ = 0;
  }
  std::array<std::uint32_t, 2> key_;
  std::uint32_t a_, b_;
  std::uint32_t index_ = 0;
  std::array<std::uint32_t, 8> block_{};
  std::uint32_t used_ = 8;
};

}  // namespace lumivox
