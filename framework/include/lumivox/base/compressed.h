// Bytes that are kept compressed (Zstandard, RFC 8878) and expanded when they are asked for.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace lumivox {

/// Compressed bytes with their expanded length.
struct Compressed {
  std::string_view stream;
  std::uint64_t expandedBytes = 0;
  /// The stream, in a string of its own or in a part of a file's string that it shares with others.
  std::shared_ptr<const std::string> holder;

  static Compressed of(std::string_view bytes);
  /// Error when the stream is damaged or holds another number of bytes.
  std::string expanded() const;
};

}  // namespace lumivox
