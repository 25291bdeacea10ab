// Bytes that are kept deflated (zlib's format, RFC 1950) and expanded when they are asked for.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace lumivox {

/// `bytes` as a zlib stream; level 1 (fast) to 12 (small), as libdeflate numbers them.
std::string zlibStream(std::string_view bytes, int level);

/// Deflated bytes with their inflated length.
struct Deflated {
  std::string_view stream;
  std::uint64_t expandedBytes = 0;
  /// The stream, in a string of its own or in a part of a file's string that it shares with others.
  std::shared_ptr<const std::string> holder;

  static Deflated ofStream(std::string stream, std::uint64_t expandedBytes);
  /// Error when the stream is damaged or holds another number of bytes.
  std::string expanded() const;
};

}  // namespace lumivox
