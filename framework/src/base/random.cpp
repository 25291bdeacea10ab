#include "lumivox/base/random.h"

namespace lumivox {

namespace {

using Counter = std::array<std::uint32_t, 4>;
using Key = std::array<std::uint32_t, 2>;

// Salmon et al. 2011, Table 2: ten rounds.
constexpr int kRounds = 10;

/// One round of Philox4x32 (Salmon et al. 2011, Sec. 3.3, with the multipliers of Table 2).
inline Counter mix(const Counter& counter, const Key& key) {
  const std::uint64_t product0 = std::uint64_t{0xD2511F53u} * counter[0];
  const std::uint64_t product1 = std::uint64_t{0xCD9E8D57u} * counter[2];
  return {
      static_cast<std::uint32_t>(product1 >> 32) ^ counter[1] ^ key[0], static_cast<std::uint32_t>(product1),
      static_cast<std::uint32_t>(product0 >> 32) ^ counter[3] ^ key[1], static_cast<std::uint32_t>(product0)};
}

/// The key of the next round: the increments are the golden ratio and sqrt(3) - 1 in 32 bits.
inline Key advance(const Key& key) {
  return {key[0] + 0x9E3779B9u, key[1] + 0xBB67AE85u};
}

}  // namespace

std::array<std::uint32_t, 4> philox4x32(std::array<std::uint32_t, 4> counter,
                                        std::array<std::uint32_t, 2> key) {
  for (int round = 0; round < kRounds; ++round, key = advance(key)) counter = mix(counter, key);
  return counter;
}

std::array<std::uint32_t, 8> philox4x32Pair(std::array<std::uint32_t, 4> counter,
                                            std::array<std::uint32_t, 2> key) {
  Counter next = counter;
  ++next[0];
  for (int round = 0; round < kRounds; ++round, key = advance(key)) {
    counter = mix(counter, key);
    next = mix(next, key);
  }
  return {counter[0], counter[1], counter[2], counter[3], next[0], next[1], next[2], next[3]};
}

}  // namespace lumivox
