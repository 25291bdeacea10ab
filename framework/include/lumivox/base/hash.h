// Content hashes (XXH3, 128 bits): the keys of caches and the provenance in reports.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace lumivox {

struct ContentHash {
  std::uint64_t high = 0, low = 0;
  bool operator==(const ContentHash&) const = default;
  auto operator<=>(const ContentHash&) const = default;
  std::string text() const;  ///< 32 hexadecimal digits
};

/// Accumulates values into one hash. The sizes of strings and vectors are hashed too, so that ("ab", "c") and
/// ("a", "bc") differ.
class Hasher {
 public:
  Hasher();
  ~Hasher();
  Hasher(Hasher&&) noexcept;
  Hasher& operator=(Hasher&&) noexcept;

  Hasher& bytes(const void* data, std::size_t size);
  Hasher& add(std::string_view text);
  template <class T>
  requires std::is_arithmetic_v<T> || std::is_enum_v<T> Hasher& add(T value) {
    return bytes(&value, sizeof(value));
  }
  template <class T>
  requires std::is_trivially_copyable_v<T> Hasher& add(const std::vector<T>& values) {
    add(std::uint64_t{values.size()});
    return bytes(values.data(), values.size() * sizeof(T));
  }
  ContentHash finish() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

ContentHash hashOf(std::string_view bytes);

}  // namespace lumivox
